/// When losses are solved, for whatever compares, ranks or links them.
#pragma once

namespace physinv {

/// Losses below this are solved: that they differ counts for nothing.
inline constexpr double kSolvedLoss = 1e-12;

}  // namespace physinv
