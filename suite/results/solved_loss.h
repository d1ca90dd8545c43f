/// When losses are solved, for whatever compares, ranks or links them.
#pragma once

namespace physinv {

/// Losses below this are solved: that they differ counts for nothing.
inline constexpr double kSolvedLoss = 1e-12;

/// A problem with a loss of at most this is solved, where neither its
/// experiment nor a flag says otherwise.
inline constexpr double kSolvedByDefault = 1e-6;

}  // namespace physinv
