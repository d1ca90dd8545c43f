/// Recomputes what a campaign claims.
#pragma once

#include <string>
#include <vector>

#include "suite/harness/registry.h"

namespace physinv {

/// Losses count as equal if bitwise so, or within this relative distance.
inline constexpr double kVerifyTolerance = 1e-12;

/// And within this one (and 1e-13) where the estimate itself is made again, by
/// plain loops through the network.
inline constexpr double kPlainTolerance = 1e-9;
/// Or, where the network is ill-conditioned, within so many times what the loss
/// moves when each parameter moves by the rounding of a sum.
inline constexpr double kRoundings = 10;

struct VerifyReport {
  std::size_t stages = 0, losses = 0;  ///< looked at
  std::size_t bitwise = 0, close = 0;  ///< equal, or within the tolerance
  /// Of examples whose estimate was not stored: again from the network's
  /// parameters; or not at all, as a layer has no plain loops.
  std::size_t by_network = 0, not_again = 0;
  std::vector<std::string> mismatches;  ///< "case stage example 3: a is b"
  std::vector<std::string> unknown;     ///< experiments not in this program
};

/// Every final loss again from the stored solution and the stored data, one
/// example at a time, in double. Where the solutions of some examples alone are
/// stored, the others come from the stored parameters of the network, and the
/// last mean_loss from all of them. Losses that are not finite must be not
/// finite again.
VerifyReport verify_results(const Results& results, const Registry& registry);

}  // namespace physinv
