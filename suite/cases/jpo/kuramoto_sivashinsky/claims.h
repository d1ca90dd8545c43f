/// What the JPO paper claims about the Kuramoto-Sivashinsky equation (Sec. 4,
/// Fig. 5, App. D.3), as conditions on results.
#pragma once

#include <optional>
#include <vector>

#include "suite/cases/jpo/common/claims.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv::ks {

inline constexpr const char* kName = "jpo/kuramoto-sivashinsky";
/// From here on the paper's statements hold; small sets can be memorised.
inline constexpr Index kMany = 32;

/// Both unknowns within 1e-3 of the truth.
Solved solved();

/// Mean share of problems on which a method beats BFGS, sizes [first, last].
std::optional<double> better(const JpoMetrics& metrics,
                             const char* method,
                             bool refined,
                             Index first,
                             Index last = kEvery);

/// R2 to R7.
std::vector<ClaimResult> claims(const Results& results);

}  // namespace physinv::ks
