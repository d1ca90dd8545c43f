/// C++ as its lexer sees it: tokens, without comments and the white space
/// between them. Edits of those change no token, and so no result.
#pragma once

#include <algorithm>
#include <array>
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
inline bool is_space(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  std::vector<Token> tokens() {
    std::vector<Token> all;
    bool first = true;  // of its line
    while (true) {
      const auto lines = skip();
      first = first || lines > 0;
      if (at_ >= text_.size()) return all;
      if (first && text_[at_] == '#')
        all.push_back({Kind::directive, directive()});
      else
        all.push_back(token());
      first = false;
    }
  }

 private:
  bool starts(std::string_view word) const {
    return text_.substr(at_).starts_with(word);
  }
  std::size_t from_here(std::string_view what) const {
    return std::min(text_.find(what, at_), text_.size());
  }

  std::size_t past_comment() const {
    return std::min(text_.find("*/", at_ + 2), text_.size() - 2) + 2;
  }

  /// Comments and white space; how many lines end in there. Of one line: up to
  /// its end.
  int skip(bool of_line = false) {
    int lines = 0;
    while (at_ < text_.size()) {
      if (starts("//"))
        at_ = from_here("\n");
      else if (starts("/*"))
        at_ = past_comment();
      else if (starts("\\\n"))
        at_ += 2;
      else if (is_space(text_[at_]) && !(of_line && text_[at_] == '\n'))
        lines += text_[at_++] == '\n' ? 1 : 0;
      else
        break;
    }
    return lines;
  }

  Token token() {
    const char c = text_[at_],
               next = at_ + 1 < text_.size() ? text_[at_ + 1] : 0;
    const auto begin = at_;
    if (c == '"' || c == '\'') return {Kind::literal, literal(begin, false)};
    if (is_digit(c) || (c == '.' && is_digit(next))) {
      number();
    } else if (is_word(c)) {
      while (at_ < text_.size() && is_word(text_[at_])) ++at_;
      const auto word = text_.substr(begin, at_ - begin);
      const bool quoted =
          at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\'');
      for (const std::string_view prefix : {"R", "u8R", "uR", "UR", "LR"})
        if (quoted && word == prefix)
          return {Kind::literal, literal(begin, true)};
      for (const std::string_view prefix : {"u8", "u", "U", "L"})
        if (quoted && word == prefix)
          return {Kind::literal, literal(begin, false)};
    } else {
      at_ += sign();
      return {Kind::sign, std::string(text_.substr(begin, at_ - begin))};
    }
    return {Kind::word, std::string(text_.substr(begin, at_ - begin))};
  }

  void number() {
    for (++at_; at_ < text_.size(); ++at_) {
      const char c = text_[at_], before = text_[at_ - 1];
      const bool exponent =
          (c == '+' || c == '-') &&
          std::string_view("eEpP").find(before) != std::string_view::npos;
      if (!is_word(c) && c != '.' && c != '\'' && !exponent) return;
    }
  }

  std::size_t sign() const {
    constexpr std::array<std::string_view, 27> kLong = {
        "<=>", "<<=", ">>=", "...", "->*", "::", "->", "++", "--",
        "<<",  ">>",  "<=",  ">=",  "==",  "!=", "&&", "||", "+=",
        "-=",  "*=",  "/=",  "%=",  "&=",  "|=", "^=", ".*", "##"};
    for (const std::string_view word : kLong)
      if (starts(word)) return word.size();
    return 1;
  }

  /// Its quote stands at `at_`, its prefix at `begin`.
  std::string literal(std::size_t begin, bool raw) {
    const char quote = text_[at_];
    if (raw) {
      const auto open = from_here("(");
      const auto close =
          ')' + std::string(text_.substr(at_ + 1, open - at_ - 1)) + '"';
      at_ = std::min(from_here(close) + close.size(), text_.size());
    } else {
      const auto open = [&] {
        return at_ < text_.size() && text_[at_] != quote && text_[at_] != '\n';
      };
      for (++at_; open(); ++at_)
        if (text_[at_] == '\\') ++at_;
      at_ = std::min(at_ + 1, text_.size());
    }
    while (at_ < text_.size() && is_word(text_[at_])) ++at_;  // 1.0_km, ""sv
    return std::string(text_.substr(begin, at_ - begin));
  }

  /// White space counts in one place: `#define A (1)` is not `#define A(1)`.
  std::string directive() {
    std::string line;
    for (int k = 0;; ++k) {
      const bool of_macro =
          k == 3 && line.starts_with("# define") && starts("(");
      if (end_of_line()) return line;
      if (k > 0 && !of_macro) line += ' ';
      line += token().text;
    }
  }

  bool end_of_line() {
    skip(true);
    return at_ >= text_.size() || text_[at_] == '\n';
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

inline std::vector<Token> tokens_of(std::string_view text) {
  return Lexer(text).tokens();
}

/// All tokens, told apart: what a hash of a source is of.
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
