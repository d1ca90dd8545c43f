#include "suite/evidence/claim_tokens.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cstddef>
#include <utility>

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

bool begins_name(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
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
    // "0 .. 5" may be written without spaces.
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
                          fmt::format("'{}' is not expected here", s[k])};
  return {Token::Kind::sign, k + 1};
}

}  // namespace

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

}  // namespace physinv
