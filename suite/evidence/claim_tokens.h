/// The text of expressions of claims.md, in tokens that know their places.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace physinv {

/// Text of a document that remembers the place of each character.
struct PlacedText {
  struct Place {
    int line = 0, column = 0;
  };
  std::string text;
  std::vector<Place> places;

  void append(std::string_view part, Place first);
  PlacedText part(std::size_t from, std::size_t to) const;
  Place place(std::size_t k) const;
};

/// What is wrong, and where.
struct ExpressionError {
  PlacedText::Place place;
  std::string what;
};

struct Token {
  enum class Kind { number, text, name, sign, end } kind;
  std::string text;  ///< without quotes; of the end: "the end"
  PlacedText::Place place;
};
using Tokens = std::vector<Token>;

/// Of ASCII, whatever the locale.
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Up to the end, a token of its own. Throws ExpressionError.
Tokens tokens_of(const PlacedText& code);

}  // namespace physinv
