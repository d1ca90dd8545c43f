#include "suite/evidence/claim_expression.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <exception>
#include <optional>
#include <utility>

#include "suite/core/decimal.h"
#include "suite/evidence/training.h"
#include "suite/results/nearest.h"

namespace physinv {

void PlacedText::append(std::string_view part, Place first) {
  for (const char c : part) {
    text += c, places.push_back(first);
    ++first.column;
  }
}

PlacedText PlacedText::part(std::size_t from, std::size_t to) const {
  const auto at = [](std::size_t k) { return static_cast<std::ptrdiff_t>(k); };
  return {text.substr(from, to - from),
          {places.begin() + at(from), places.begin() + at(to)}};
}

PlacedText::Place PlacedText::place(std::size_t k) const {
  if (places.empty()) return {};
  if (k < places.size()) return places[k];
  return {places.back().line, places.back().column + 1};
}

namespace {

using Place = PlacedText::Place;

struct Token {
  enum class Kind { number, text, name, sign, end } kind;
  std::string text;
  Place place;
};
using Tokens = std::vector<Token>;

bool begins_name(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}
bool goes_on(char c) { return begins_name(c) || is_digit(c); }

/// Where the token ends that begins at k; its kind.
std::pair<Token::Kind, std::size_t> token_at(const PlacedText& code,
                                             std::size_t k) {
  const std::string& s = code.text;
  if (begins_name(s[k])) {
    std::size_t end = k;
    while (end < s.size() && goes_on(s[end])) ++end;
    return {Token::Kind::name, end};
  }
  if (is_digit(s[k])) {
    double value = 0;
    const char* last = s.data() + s.size();
    const auto read = std::from_chars(s.data() + k, last, value);
    auto end = static_cast<std::size_t>(read.ptr - s.data());
    // "0 .. 5" may stand without spaces.
    if (const auto range = s.find("..", k); range < end) end = range;
    return {Token::Kind::number, end};
  }
  if (s[k] == '"') {
    const auto end = s.find('"', k + 1);
    if (end == std::string::npos)
      throw ExpressionError{code.place(k), "this text has no end"};
    return {Token::Kind::text, end + 1};
  }
  for (const std::string_view sign : {">=", "<=", "..", "+-"})
    if (s.compare(k, 2, sign) == 0) return {Token::Kind::sign, k + 2};
  if (std::string_view("()[],+-*/<>=").find(s[k]) == std::string_view::npos)
    throw ExpressionError{code.place(k),
                          fmt::format("'{}' means nothing here", s[k])};
  return {Token::Kind::sign, k + 1};
}

Tokens tokens_of(const PlacedText& code) {
  Tokens all;
  for (std::size_t k = 0; k < code.text.size();) {
    if (std::isspace(static_cast<unsigned char>(code.text[k])) != 0) {
      ++k;
      continue;
    }
    const auto [kind, end] = token_at(code, k);
    const bool quoted = kind == Token::Kind::text;
    all.push_back({kind,
                   code.text.substr(k + quoted, end - k - 2 * quoted),
                   code.place(k)});
    k = end;
  }
  all.push_back({Token::Kind::end, "the end", code.place(code.text.size())});
  return all;
}

std::string kind_of_value(const ClaimValue& v) { return kind_of(v.type()); }

constexpr int kDeepest = 50;        ///< parentheses, calls of defined functions
constexpr int kMostCalls = 10'000;  ///< of an expression
constexpr std::size_t kLongestText = 1000;  ///< of parts that are joined

/// What parameters of a defined function are.
using Locals = std::map<std::string, ClaimValue>;

/// Reads tokens from left to right and computes as it reads.
class Expression {
 public:
  Expression(const Tokens& tokens,
             const ClaimNames& names,
             const Locals& locals,
             int& calls_left,
             int depth = 0)
      : tokens_(tokens),
        names_(names),
        locals_(locals),
        calls_left_(calls_left),
        depth_(depth) {}

  ClaimValue sum() {
    ClaimValue left = product();
    while (is("+") || is("-")) {
      const Token sign = take();
      left = combined(sign, left, product());
    }
    return left;
  }

  bool is(std::string_view text) const {
    return now().kind != Token::Kind::text && now().text == text;
  }
  bool take_if(std::string_view text) {
    if (!is(text)) return false;
    ++next_;
    return true;
  }
  void expect(std::string_view text) {
    if (!take_if(text)) fail(fmt::format("'{}' is missing here", text));
  }
  Token take() { return tokens_[next_++]; }
  const Token& now() const { return tokens_[next_]; }
  /// What has not been read.
  Tokens rest() const {
    return {tokens_.begin() + static_cast<std::ptrdiff_t>(next_),
            tokens_.end()};
  }
  void expect_end() {
    if (now().kind != Token::Kind::end)
      fail(fmt::format("'{}' is not expected here", now().text));
  }
  [[noreturn]] void fail(std::string what) const {
    throw ExpressionError{now().place, std::move(what)};
  }

  template <class T>
  T as(const ClaimValue& value, const Place& place) const {
    auto converted = claim_value_as<T>(value);
    if (!converted)
      throw ExpressionError{place,
                            fmt::format("this is {}, {} is needed",
                                        kind_of_value(value),
                                        kind_of(typeid(T)))};
    return std::move(*converted);
  }
  template <class T>
  T sum_as() {
    const Place place = now().place;
    return as<T>(sum(), place);
  }

 private:
  ClaimValue product() {
    ClaimValue left = factor();
    while (is("*") || is("/")) {
      const Token sign = take();
      left = combined(sign, left, factor());
    }
    return left;
  }

  ClaimValue factor() {
    const Token t = now();
    if (depth_ > kDeepest) fail("this is nested too deeply");
    if (t.kind == Token::Kind::end) fail("an expression is missing here");
    ++next_;
    if (t.kind == Token::Kind::number) {
      if (const auto number = decimal<double>(t.text)) return *number;
      throw ExpressionError{t.place, t.text + " is no number that fits"};
    }
    if (t.kind == Token::Kind::text) return t.text;
    if (t.kind == Token::Kind::name) return is("(") ? call(t) : value(t);
    if (t.text == "-") {
      ++depth_;
      const double negative = -as<double>(factor(), now().place);
      --depth_;
      return negative;
    }
    if (t.text == "(") {
      ++depth_;
      ClaimValue inner = sum();
      --depth_;
      expect(")");
      return inner;
    }
    if (t.text == "[") return list("]");
    throw ExpressionError{t.place,
                          fmt::format("'{}' is not expected here", t.text)};
  }

  ClaimList list(std::string_view close) {
    ClaimList all;
    ++depth_;
    while (!is(close)) {
      if (!all.empty()) expect(",");
      all.push_back(sum());
    }
    --depth_;
    expect(close);
    return all;
  }

  ClaimValue value(const Token& t) const {
    if (const auto local = locals_.find(t.text); local != locals_.end())
      return local->second;
    if (const ClaimValue* found = names_.value(t.text)) return *found;
    if (names_.functions(t.text) != nullptr)
      throw ExpressionError{t.place,
                            t.text + " is a function and takes arguments"};
    unknown(t);
  }

  ClaimValue call(const Token& t) {
    ++next_;
    const ClaimList arguments = list(")");
    const auto* functions = names_.functions(t.text);
    if (functions == nullptr) unknown(t);
    if (--calls_left_ < 0)
      throw ExpressionError{t.place, "this makes too many calls"};
    std::vector<std::string> forms;
    for (const ClaimNames::Function& f : *functions) {
      if (f.parameters.size() == arguments.size())
        if (auto result = result_of_call(f, arguments, t))
          return std::move(*result);
      std::vector<std::string> kinds;
      for (const auto& p : f.parameters) kinds.push_back(kind_of(p));
      forms.push_back(fmt::format("({})", fmt::join(kinds, ", ")));
    }
    std::vector<std::string> given;
    for (const ClaimValue& v : arguments) given.push_back(kind_of_value(v));
    throw ExpressionError{t.place,
                          fmt::format("{} takes {}, not ({})",
                                      t.text,
                                      fmt::join(forms, " or "),
                                      fmt::join(given, ", "))};
  }

  /// What the function throws stands where it was called.
  std::optional<ClaimValue> result_of_call(const ClaimNames::Function& f,
                                           const ClaimList& arguments,
                                           const Token& t) const {
    try {
      return f.call({arguments, names_, depth_ + 1, calls_left_});
    } catch (const std::exception& error) {
      throw ExpressionError{t.place, error.what()};
    }
  }

  [[noreturn]] void unknown(const Token& t) const {
    const std::string near = nearest_word(names_.all(), t.text);
    throw ExpressionError{
        t.place,
        fmt::format(
            "there is no '{}'{}",
            t.text,
            near.empty() ? "" : fmt::format("; did you mean {}?", near))};
  }

  /// Of text and of numbers, as parts of names have them: "-b" + 8.
  static std::optional<std::string> written(const ClaimValue& value) {
    if (const auto* number = std::any_cast<double>(&value))
      return fmt::format("{}", *number);
    return claim_value_as<std::string>(value);
  }

  /// left sign right.
  static ClaimValue combined(const Token& sign,
                             const ClaimValue& left,
                             const ClaimValue& right) {
    const char s = sign.text.front();
    const auto *a = std::any_cast<double>(&left),
               *b = std::any_cast<double>(&right);
    if (a != nullptr && b != nullptr)
      return s == '+'   ? *a + *b
             : s == '-' ? *a - *b
             : s == '*' ? *a * *b
                        : *a / *b;
    if (const auto* text = std::any_cast<std::string>(&left);
        s == '+' && text != nullptr)
      if (const auto end = written(right)) {
        if (text->size() + end->size() > kLongestText)
          throw ExpressionError{sign.place, "this text is too long"};
        return *text + *end;
      }
    const auto *of = std::any_cast<RunValue>(&left),
               *under = std::any_cast<RunValue>(&right);
    if (s == '/' && of != nullptr && under != nullptr) return over(*of, *under);
    const auto q = claim_value_as<Quantity>(left),
               r = claim_value_as<Quantity>(right);
    if (q && r && s == '/') return ratio(*q, *r);
    if (q && r && s == '-') return difference(*q, *r);
    if (r && s == '*' && a != nullptr) return times(*a, *r);
    throw ExpressionError{sign.place,
                          fmt::format("{} {} {} has no meaning",
                                      kind_of_value(left),
                                      sign.text,
                                      kind_of_value(right))};
  }

  const Tokens& tokens_;
  const ClaimNames& names_;
  const Locals& locals_;
  int& calls_left_;
  int depth_;
  std::size_t next_ = 0;
};

/// "as printed(name, seeds)" or "as stated(value, seeds)".
Condition as_relation(Expression& e, const std::string& label, Quantity q) {
  const Token kind = e.take();
  if (kind.text != "printed" && kind.text != "stated")
    throw ExpressionError{kind.place,
                          "'as' asks for printed(\"name\", seeds) or "
                          "stated(value, seeds)"};
  e.expect("(");
  if (kind.text == "printed") {
    auto name = e.sum_as<std::string>();
    e.expect(",");
    return as_printed(label, std::move(q), std::move(name), e.sum_as<Index>());
  }
  const auto value = e.sum_as<double>();
  e.expect(",");
  return as_stated(label, std::move(q), value, e.sum_as<Index>());
}

Condition of_relation(Expression& e,
                      const Token& relation,
                      const std::string& label,
                      Quantity q) {
  const std::string& r = relation.text;
  if (r == "as") {
    Condition c = as_relation(e, label, std::move(q));
    e.expect(")");
    return c;
  }
  if (r == ">") return above(label, std::move(q), e.sum_as<Quantity>());
  if (r == "<") return below(label, std::move(q), e.sum_as<Quantity>());
  if (r == ">=") return at_least(label, std::move(q), e.sum_as<Quantity>());
  if (r == "<=") return at_most(label, std::move(q), e.sum_as<Quantity>());
  const auto value = e.sum_as<double>();
  if (r == "near") return near(label, std::move(q), value);
  if (r == "about") return about(label, std::move(q), value);
  if (r == "=")
    return equals(
        label, std::move(q), value, e.take_if("+-") ? e.sum_as<double>() : 0);
  e.expect("..");
  return within(label, std::move(q), value, e.sum_as<double>());
}

constexpr std::string_view kRelations[] = {
    ">", "<", ">=", "<=", "in", "near", "about", "=", "as"};

/// What an expression without a relation says: a number to report, or the
/// conditions that a function made.
std::vector<Condition> without_relation(const Expression& e,
                                        const std::string& label,
                                        const ClaimValue& value,
                                        const Place& place) {
  if (const auto* labelled = std::any_cast<Labelled>(&value))
    return (*labelled)(label);
  if (const auto* one = std::any_cast<Condition>(&value)) return {*one};
  if (const auto all = claim_value_as<std::vector<Condition>>(value)) {
    if (!label.empty())
      throw ExpressionError{place,
                            "the function has labels of its own: leave the "
                            "line's away"};
    return *all;
  }
  return {reported(label, e.as<Quantity>(value, place))};
}

std::vector<std::string> parameters_of(Expression& e) {
  std::vector<std::string> all;
  if (!e.take_if("(")) return all;
  while (!e.is(")")) {
    if (!all.empty()) e.expect(",");
    if (e.now().kind != Token::Kind::name) e.fail("a name is missing here");
    all.push_back(e.take().text);
  }
  e.expect(")");
  return all;
}

}  // namespace

std::vector<Condition> conditions_of(const std::string& label,
                                     const PlacedText& code,
                                     const ClaimNames& names) {
  const Tokens tokens = tokens_of(code);
  const Locals none;
  int calls_left = kMostCalls;
  Expression e(tokens, names, none, calls_left);
  const Place place = e.now().place;
  const ClaimValue left = e.sum();
  std::vector<Condition> all;
  if (std::any_of(std::begin(kRelations),
                  std::end(kRelations),
                  [&](std::string_view r) { return e.is(r); })) {
    const Token relation = e.take();
    all = {of_relation(e, relation, label, e.as<Quantity>(left, place))};
  } else {
    all = without_relation(e, label, left, place);
  }
  if (e.take_if("of")) {
    e.expect("stages");
    for (Condition& c : all) c = of_stages(std::move(c));
  }
  e.expect_end();
  return all;
}

void define(const PlacedText& code, ClaimNames& names) {
  const Tokens tokens = tokens_of(code);
  const Locals none;
  int calls_left = kMostCalls;
  Expression e(tokens, names, none, calls_left);
  if (e.now().kind != Token::Kind::name) e.fail("a name is missing here");
  const Token name = e.take();
  const bool is_function = e.is("(");
  const std::vector<std::string> parameters = parameters_of(e);
  e.expect("=");
  if (!is_function) {
    names.set(name.text, e.sum());
    e.expect_end();
    return;
  }
  names.add(
      name.text,
      ClaimNames::Function{
          std::vector<std::type_index>(parameters.size(), typeid(ClaimValue)),
          [parameters, body = e.rest()](
              const ClaimNames::Call& call) -> std::optional<ClaimValue> {
            Locals locals;
            for (std::size_t k = 0; k < parameters.size(); ++k)
              locals[parameters[k]] = call.arguments[k];
            Expression inside(
                body, call.names, locals, call.calls_left, call.depth);
            ClaimValue result = inside.sum();
            inside.expect_end();
            return result;
          }});
}

}  // namespace physinv
