/// Recomputes what a campaign claims.
#pragma once

#include <string>
#include <vector>

#include "suite/harness/registry.h"

namespace physinv {

/// Losses count as equal if bitwise so, or within this relative distance.
inline constexpr double kVerifyTolerance = 1e-12;

struct VerifyReport {
  std::size_t stages = 0, losses = 0;   ///< looked at
  std::size_t bitwise = 0, close = 0;   ///< equal, or within the tolerance
  std::vector<std::string> mismatches;  ///< "case stage example 3: a is b"
  std::vector<std::string> unknown;     ///< experiments not in this program
};

/// Every final loss again from the stored solution and the stored data, one
/// example at a time, in double. Losses that are not finite must be not finite
/// again.
VerifyReport verify_results(const Results& results, const Registry& registry);

}  // namespace physinv
