/// Which losses are solved, and which are equal (docs/output.md).
#pragma once

namespace physinv {

/// Losses below this are equal: ranks, ratios and tests ignore differences.
inline constexpr double kEqualLoss = 1e-12;

/// A problem with a loss of at most this is solved, where neither its
/// experiment nor a flag says otherwise.
inline constexpr double kSolvedByDefault = 1e-6;

}  // namespace physinv
