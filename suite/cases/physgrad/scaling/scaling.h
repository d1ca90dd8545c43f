/// The chapter's two toys, and numbers of a step that no trajectory shows.
#pragma once

#include <memory>
#include <string>

#include "suite/core/method.h"

namespace physinv::scaling {

/// y = (x1, alpha x2): one problem for each alpha.
inline constexpr const char* kScaling = "physgrad/scaling";
/// y = (x1, x2^2), from (3, 3).
inline constexpr const char* kComparison = "physgrad/comparison";

inline constexpr double kRate = 0.3;  ///< of all steps that undo the scale

/// Stage `identities`, a diagnostic of single steps. Arrays, a column each:
///   order   of one step of PG and IG from (3, 3) on y = (x1, x2^2), the rate
///           halved six times: |dy|, |PG - IG|, |P(x + dx) - (y + dy)|
///   linear  of L = alpha x: alpha, loss changes of GD (rate 0.1) and of an
///           IG step that asks for 0.1
///   roots   of the local inverse of x^2: y, x0, the root
///   inner   change of y2 over the asked one, for inner functions alpha x and
///           x^2: inverse gradient, Newton, gradient descent
///   average rate, dx2 / dy2 of the inverse simulator, mean local gradient
///   local   e, |P^-1(P(1 + e); 1) - (1 + e)| of x^2
///   singular  second derivative, is gradient over it finite, is Newton's step
///   small   alpha, share of x2 in a step: gradient descent, inverse gradient
///   reversed  time step, distance from the start after forth and back
std::shared_ptr<const Stage> identities();

/// Stages gd, newton, ig and pg of n random trajectories each, a diagnostic
/// whose solving time is that of all steps. Arrays `batch` (n, steps) and
/// `ends` (mean and largest |x|, a column for x1 and one for x2).
Method batch(std::string id, int power, Index n);

}  // namespace physinv::scaling
