/// What claims.md has as code: conditions, and definitions of names.
#pragma once

#include <string>
#include <vector>

#include "suite/evidence/claim_names.h"
#include "suite/evidence/claim_tokens.h"

namespace physinv {

/// The conditions of a line. Throws ExpressionError.
std::vector<Condition> conditions_of(const std::string& label,
                                     const PlacedText& code,
                                     const ClaimNames& names);

/// "name = expression" or "name(a, b) = expression", added to the names.
/// Throws ExpressionError.
void define(const PlacedText& code, ClaimNames& names);

}  // namespace physinv
