/// What the JPO paper claims about wave packets (Sec. 4, Fig. 3, App. D.1), as
/// conditions on results.
#pragma once

#include <vector>

#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv::packet {

inline constexpr const char* kName = "jpo/wave-packet";
inline constexpr double kBasin = 1;  ///< width of the global one, in samples

/// R2 to R6, and Table 4.
std::vector<ClaimResult> claims(const Results& results);

}  // namespace physinv::packet
