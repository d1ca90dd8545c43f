/// C++ as its lexer sees it: tokens, without comments and the white space
/// between them. Edits of those change no token, and so no result.
#pragma once

#include <re2/re2.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace physinv::source {

enum class Kind {
  word,      ///< an identifier, a keyword or a number
  literal,   ///< a string or a character, with prefix and suffix
  sign,      ///< the longest operator or bracket
  directive  ///< a line of the preprocessor, with spaces between tokens
};

struct Token {
  Kind kind;
  std::string text;
};

inline bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

inline Kind kind_of(std::string_view token) {
  if (is_digit(token[0]) ||
      (token[0] == '.' && token.size() > 1 && is_digit(token[1])))
    return Kind::word;
  if (token.find_first_of("\"'") != token.npos) return Kind::literal;
  return is_word(token[0]) ? Kind::word : Kind::sign;
}

/// Takes a token, whose first character is no white space, from the front.
inline std::string take_token(re2::StringPiece& rest) {
  using re2::RE2;
  static const RE2 kRaw(R"re((?:u8|[uUL])?R"([^()\\\s]*)\()re", RE2::Latin1);
  static const RE2 kSuffix(R"(\w*)", RE2::Latin1);
  static const RE2 kToken(
      "(?s)(?:"
      R"re((?:u8|[uUL])?(?:"(?:\\.|[^"\\\n])*"?|'(?:\\.|[^'\\\n])*'?)\w*|)re"
      R"(\.?\d(?:[eEpP][+-]|['.\w])*|\w+|)"  // a number, a word
      R"(<=>|(?:<<|>>)=?|\.\.\.|->\*?|::|\+\+|--|&&|\|\||##|\.\*|)"
      R"([-<>=!+*/%&|^]=|.))",
      RE2::Latin1);
  const char* const begin = rest.data();
  re2::StringPiece name;
  if (RE2::Consume(&rest, kRaw, &name)) {
    const auto close = ')' + std::string(name.data(), name.size()) + '"';
    const auto end = rest.find(close);
    rest.remove_prefix(end == rest.npos ? rest.size() : end + close.size());
    RE2::Consume(&rest, kSuffix);  // ""sv
  } else {
    RE2::Consume(&rest, kToken);
  }
  return {begin, rest.data()};
}

inline std::vector<Token> tokens_of(std::string_view text) {
  using re2::RE2;
  static const RE2 kGap(
      R"((?s)(?:[ \t\r\v\f]|\\\n|//[^\n]*|/\*(?:.*?\*/|.*))+)", RE2::Latin1);
  std::vector<Token> all;
  re2::StringPiece rest(text.data(), text.size());
  bool first = true, directive = false;  // of its line
  while (true) {
    const bool glued = !RE2::Consume(&rest, kGap);
    if (rest.empty()) return all;
    if (rest[0] == '\n') {
      rest.remove_prefix(1);
      first = true, directive = false;
      continue;
    }
    const std::string token = take_token(rest);
    if (directive) {
      // White space counts in one place: `#define A (1)` is not `A(1)`.
      std::string& line = all.back().text;
      const bool of_macro = glued && token == "(" &&
                            line.starts_with("# define ") &&
                            std::count(line.begin(), line.end(), ' ') == 2;
      line += (of_macro ? "" : " ") + token;
    } else {
      directive = first && token == "#";
      all.push_back({directive ? Kind::directive : kind_of(token), token});
    }
    first = false;
  }
}

/// All tokens with separators: the hash of a source is computed from them.
inline std::string substance(const std::vector<Token>& tokens) {
  std::string text;
  for (const Token& token : tokens) text += token.text + '\0';
  return text;
}

/// Headers of the project that lines `#include "..."` name, a space behind
/// each.
inline std::string includes(const std::vector<Token>& tokens) {
  constexpr std::string_view kInclude = "# include \"";
  std::string names;
  for (const Token& token : tokens) {
    if (token.kind != Kind::directive || !token.text.starts_with(kInclude))
      continue;
    const auto name = std::string_view(token.text).substr(kInclude.size());
    names += name.substr(0, name.find('"'));
    names += ' ';
  }
  return names;
}

}  // namespace physinv::source
