/// NLopt's local minimizers with derivatives (S. G. Johnson, "The NLopt
/// nonlinear-optimization package"). By default they have no tolerance at all:
/// they end by themselves or where `iterations` evaluations are made.
#pragma once

#include <memory>

#include "suite/core/method.h"
#include "task.h"

namespace libraries {

enum class NloptAlgorithm : std::uint8_t { lbfgs, slsqp, mma };

/// Stage `solve`: the algorithm on the true loss from the start. NLopt reports
/// no iterates: an evaluation that is lower than all before it counts as one.
/// Ends as `gtol` where NLopt says success, `maxiter` after so many
/// evaluations, else `linesearch`.
std::shared_ptr<const physinv::Stage> nlopt_solve(NloptAlgorithm algorithm,
                                                  const Task& task);

}  // namespace libraries
