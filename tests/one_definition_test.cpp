// Reads every source: a type, a template, an inline function or variable that
// is defined twice under one name is two for the compiler and one for the
// linker, which takes either.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "cmake/tokens.h"

namespace {

namespace fs = std::filesystem;
using Tokens = std::vector<std::string>;

using physinv::source::is_word;

/// Words and signs, without literals and lines of the preprocessor.
Tokens tokens_of(std::string_view text) {
  using physinv::source::Kind;
  Tokens all;
  for (const auto& token : physinv::source::tokens_of(text)) {
    if (token.kind == Kind::literal)
      all.emplace_back("\"\"");
    else if (token.kind == Kind::word || token.text == "::")
      all.push_back(token.text);
    else if (token.kind == Kind::sign)
      for (const char c : token.text) all.emplace_back(1, c);
  }
  return all;
}

std::string joined(const Tokens& tokens, std::size_t from, std::size_t to) {
  std::string text;
  for (; from < to; ++from) {
    if (!text.empty() && is_word(text.back()) && is_word(tokens[from][0]))
      text += ' ';
    text += tokens[from];
  }
  return text;
}

/// Behind the bracket that closes the one at `at`.
std::size_t behind(const Tokens& t, std::size_t at) {
  static const std::map<std::string, std::string> kPairs = {
      {"(", ")"}, {"{", "}"}, {"<", ">"}, {"[", "]"}};
  const auto &open = t[at], &close = kPairs.at(open);
  int depth = 0;
  for (; at < t.size(); ++at) {
    // A comparison between parentheses closes nothing.
    if (open == "<" && t[at] == "(")
      at = behind(t, at) - 1;
    else if (t[at] == open)
      ++depth;
    else if (t[at] == close && --depth == 0)
      return at + 1;
  }
  return at;
}

/// Parameters by their types: no names, no defaults.
std::string types_of(const Tokens& t, std::size_t from, std::size_t to) {
  std::string all;
  Tokens one;
  const auto end_one = [&] {
    const std::size_t n = one.size();
    if (n > 1 && is_word(one[n - 1][0]) && one[n - 2] != "::") one.pop_back();
    if (n > 0) all += joined(one, 0, one.size()) + ',';
    one.clear();
  };
  for (bool in_default = false; from < to; ++from) {
    if (t[from] == ",") {
      end_one(), in_default = false;
      continue;
    }
    const std::size_t next = t[from] == "<" || t[from] == "(" || t[from] == "{"
                                 ? behind(t, from)
                                 : from + 1;
    in_default = in_default || t[from] == "=";
    if (!in_default) one.insert(one.end(), &t[from], &t[0] + next);
    from = next - 1;
  }
  end_one();
  return all;
}

/// What the tokens before a '{' define that may be in several objects: "" if
/// nothing of that kind.
std::string defined_by(const Tokens& head) {
  std::size_t i = 0;
  bool shared = false;
  std::string constraint;
  while (i < head.size() && head[i] == "template") {
    shared = true;
    i = behind(head, i + 1);
    if (i < head.size() && head[i] == "requires") {
      const std::size_t from = i++;
      if (head[i] == "(")
        i = behind(head, i);
      else
        while (i + 1 < head.size() && (head[i + 1] == "::" || head[i] == "::"))
          ++i;
      if (i < head.size() && is_word(head[i][0])) ++i;
      if (i < head.size() && head[i] == "<") i = behind(head, i);
      constraint = joined(head, from, i);
    }
  }
  if (i < head.size() &&
      std::set<std::string>{"struct", "class", "union", "enum"}.contains(
          head[i])) {
    if (head[++i] == "class" || head[i] == "struct") ++i;
    if (head[i] == "alignas") i = behind(head, i + 1);
    std::size_t end = i;
    while (end < head.size() && head[end] != ":" && head[end] != "final" &&
           head[end] != "(")
      ++end;
    if (end == head.size() || head[end] != "(") return joined(head, i, end);
  }
  std::size_t open = i;
  for (; open < head.size() && head[open] != "("; ++open) {
    shared = shared || head[open] == "inline" || head[open] == "constexpr" ||
             head[open] == "consteval";
    if (head[open] == "=") return "";
    if (head[open] == "<" && head[open - 1] != "operator")
      open = behind(head, open) - 1;
  }
  if (!shared || open >= head.size() || open == i) return "";
  std::size_t name = open - 1;
  while (name > i && !is_word(head[name][0]))
    --name;  // the sign of an operator
  while (name > i + 1 && head[name - 1] == "::") {
    name -= 2;
    if (head[name] == ">")
      while (name > i && head[name + 1] != "<") --name;
  }
  return joined(head, name, open) + '(' +
         types_of(head, open + 1, behind(head, open) - 1) + ')' + constraint;
}

/// The variable that the tokens before a '{' or ';' define for all objects.
std::string inline_variable(const Tokens& head) {
  const bool is_template =
      head.size() > 1 && head[0] == "template" && head[1] == "<";
  std::size_t end = is_template ? behind(head, 1) : 0;
  bool shared = false;
  for (; end < head.size() && head[end] != "=" && head[end] != "["; ++end) {
    if (head[end] == "(" || head[end] == "namespace") return "";
    shared = shared || head[end] == "inline";
  }
  if (!shared || end == 0) return "";
  if (head[end - 1] != ">") return head[end - 1];
  std::size_t name = end - 1;  // of a specialization: with its arguments
  while (name > 0 && head[name] != "<") --name;
  return name > 0 ? joined(head, name - 1, end) : "";
}

/// Namespace and name of all that a source defines so, outside unnamed
/// namespaces; `unnamed` counts those.
std::set<std::string> definitions(const Tokens& t, int* unnamed = nullptr) {
  std::set<std::string> all;
  std::vector<std::string> scopes;
  Tokens head;
  const auto add = [&](const std::string& name) {
    bool hidden = name.empty();
    std::string path;
    for (const auto& scope : scopes)
      hidden = hidden || scope.empty(), path += scope + "::";
    if (!hidden) all.insert(path + name);
  };
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t[i] == ";" || t[i] == "}") {
      if (t[i] == ";") add(inline_variable(head));
      if (t[i] == "}" && !scopes.empty()) scopes.pop_back();
      head.clear();
    } else if (t[i] == "(") {  // with the braces of its defaults
      const std::size_t end = behind(t, i);
      head.insert(head.end(), &t[i], &t[0] + end);
      i = end - 1;
    } else if (t[i] != "{") {
      head.push_back(t[i]);
    } else if (!head.empty() &&
               (head[0] == "namespace" ||
                (head[0] == "inline" && head[1] == "namespace"))) {
      scopes.push_back(joined(head, head[0] == "inline" ? 2 : 1, head.size()));
      if (scopes.back().empty() && unnamed != nullptr) ++*unnamed;
      head.clear();
    } else if (head.size() == 2 && head[0] == "extern") {
      scopes.emplace_back("C"), head.clear();
    } else {
      add(defined_by(head));
      add(inline_variable(head));
      // A function's initializers in braces continue.
      i = behind(t, i) - 1;
      if (i + 1 >= t.size() || (t[i + 1] != "," && t[i + 1] != "{"))
        head.clear();
    }
  }
  return all;
}

using Definitions = std::map<std::string, std::set<std::string>>;

TEST(OneDefinition, NothingIsDefinedInTwoFiles) {
  const fs::path root = PHYSINV_SOURCE_DIR;
  Definitions files_of;
  for (const char* top :
       {"suite", "problems", "optimizers", "baselines", "reports", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const auto extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      const auto file = fs::relative(entry.path(), root).generic_string();
      int unnamed = 0;
      for (const auto& name : definitions(tokens_of(text.str()), &unnamed))
        files_of[name].insert(file);
      if (extension != ".h") continue;
      EXPECT_EQ(unnamed, 0) << file << ": every source would get its own";
    }
  }
  EXPECT_GT(files_of.size(), 1000U);
  for (const auto& [name, files] : files_of) {
    if (name.ends_with("main()")) continue;
    std::string places;
    for (const auto& file : files) places += "\n  " + file;
    EXPECT_EQ(files.size(), 1U) << name << " is defined in" << places;
  }
}

std::set<std::string> read(std::string_view text) {
  return definitions(tokens_of(text));
}

TEST(OneDefinition, TypesByTheirNames) {
  using Names = std::set<std::string>;
  EXPECT_EQ(read("namespace a { struct J { int x; struct In {}; }; }"),
            Names{"a::J"});
  EXPECT_EQ(read("namespace a::b {\nclass J final : public K<{}> {}; }"),
            Names{"a::b::J"});
  EXPECT_EQ(read("enum class E : unsigned { x }; union alignas(8) U {};"),
            (Names{"E", "U"}));
  EXPECT_EQ(read("template <class T, int n = (2 > 1)>\nstruct S<T*> {};"),
            Names{"S<T*>"});
  EXPECT_EQ(read("namespace { struct Hidden {}; } struct Seen {};"),
            Names{"Seen"});
  EXPECT_EQ(read("struct Named; struct Named f();"), Names{});
}

TEST(OneDefinition, LiteralsAndCommentsDefineNothing) {
  EXPECT_TRUE(read("// struct A {};\n/* struct B {}; */").empty());
  EXPECT_TRUE(read("#define C \\\n  struct C {}\nint x = 1'000;").empty());
  EXPECT_TRUE(read("auto s = \"struct A {\", c = '{', q = '\\'';").empty());
  EXPECT_TRUE(read("auto r = R\"x(struct A {)\" )x\";").empty());
  EXPECT_TRUE(read("void f() { struct Local {}; }").empty());
}

TEST(OneDefinition, InlineFunctionsAndVariables) {
  const auto same = [](std::string_view a, std::string_view b) {
    EXPECT_EQ(read(a).size(), 1U) << a;
    return read(a) == read(b);
  };
  EXPECT_TRUE(same("inline int f(int a, double b = 1) { return a; }",
                   "inline int f(int x, double) { return 2; }"));
  EXPECT_TRUE(same("template <class T> T f(const A<T, 2>& a) { return a; }",
                   "template <class T>\nT f(const A<T, 2>& b) { return b; }"));
  EXPECT_FALSE(same("inline int f(int a) { return a; }",
                    "inline int f(long a) { return 2; }"));
  EXPECT_FALSE(same("template <class T> requires A<T> void f(T t) {}",
                    "template <class T> requires B<T> void f(T t) {}"));
  EXPECT_TRUE(
      read("template <class T>\nT f(const A& a = {}, int b = 1);").empty());
  EXPECT_EQ(
      read("template <class T> void S<T>::f(T (*g)(int)) const {}").size(), 1U);
  EXPECT_EQ(read("inline A operator+(A a, A b) { return a; }"),
            std::set<std::string>{"operator+(A,A,)"});
  EXPECT_EQ(read("inline constexpr std::array<int, 2> kA = {1, 2};\n"
                 "template <class T> inline constexpr int kB = 1;\n"
                 "inline constexpr int kC[] = {1}; inline constexpr S kD{2};"),
            (std::set<std::string>{"kA", "kB", "kC", "kD"}));
  // The linker refuses the others itself.
  EXPECT_TRUE(read("int f(int a) { return a; }").empty());
  EXPECT_TRUE(read("static const std::vector<int> v = {f(1)};").empty());
}

TEST(OneDefinition, TwoStructsOfOneNameAreSeen) {
  const auto gate =
      read("namespace physinv {\nstruct Judgement { int a; };\n}");
  const auto expected = read("namespace physinv { struct Judgement {}; }");
  EXPECT_EQ(gate, expected);
}

}  // namespace
