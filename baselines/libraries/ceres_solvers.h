/// Ceres' GradientProblemSolver (S. Agarwal, K. Mierle, "Ceres Solver"): line
/// search along the directions of BFGS or L-BFGS, with its defaults but for the
/// limit of iterations.
#pragma once

#include <cstdint>
#include <memory>

#include "suite/core/method.h"
#include "task.h"

namespace libraries {

enum class CeresDirection : std::uint8_t { bfgs, lbfgs };

/// Stage `solve`: the solver on the true loss from the start. Ends as `gtol`
/// where Ceres says CONVERGENCE (by the relative change of the loss, by the
/// gradient or by the step), as `maxiter` where it says NO_CONVERGENCE, else as
/// `linesearch`. Takes no bounds.
std::shared_ptr<const physinv::Stage> ceres_solve(CeresDirection direction,
                                                  const Task& task);

}  // namespace libraries
