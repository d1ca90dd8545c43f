/// Claims of the study: the JPO paper's sentences about BFGS on its four
/// experiments together (claims P1 to P3 of `jpo`), against each library's.
#pragma once

#include <string>
#include <vector>

#include "suite/evidence/claim.h"

namespace libraries {

/// The problems of Sec. 4 of the paper, in its order; their claims stand with
/// the first one.
const std::vector<std::string>& section4();

std::string study_of(const std::string& problem);

std::vector<physinv::Claim> whose_bfgs_claims();

}  // namespace libraries
