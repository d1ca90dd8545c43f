/// The expressions of claims.md. Numbers of a campaign are added to nothing but
/// numbers, subtracted, divided, and multiplied by numbers; values of a run are
/// divided. To text, text and numbers are added: "sip-b" + 8.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "suite/evidence/claim_names.h"

namespace physinv {

/// Text of a document that remembers where each of its characters stands.
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

/// The conditions of a line. Throws ExpressionError.
std::vector<Condition> conditions_of(const std::string& label,
                                     const PlacedText& code,
                                     const ClaimNames& names);

/// "name = expression" or "name(a, b) = expression", added to the names.
/// Throws ExpressionError.
void define(const PlacedText& code, ClaimNames& names);

}  // namespace physinv
