/// Plain steps of fixed rate that differ in what they know of the solver
/// (Physics-based deep learning, chapter "Scale-invariance and inversion"):
///
///   gradient           x -= rate d loss / d x
///   newton             x -= rate H^-1 d loss / d x
///   inverse_gradient   x += J^-1 dy,        dy = rate (y* - y)
///   inverse_simulator  x  = P^-1(y + dy; x)
///
/// There is no line search. An unknown that H or J does not see, its pivot an
/// exact zero, stays where it is. Problems are independent of each other. A
/// step that is not finite is not taken, and ends its problem with status
/// nonfinite; with all problems ended, the stage has diverged.
///
/// Arrays left: `mean_loss` (1 x points of the curve), `path` (unknowns x
/// iterations + 1) of the first problem.
#pragma once

#include <memory>
#include <string>

#include "suite/core/method.h"

namespace physinv {

enum class LocalStep : std::uint8_t {
  gradient,
  newton,
  inverse_gradient,
  inverse_simulator
};

struct LocalStepsOptions {
  std::string stage = "steps";
  LocalStep step = LocalStep::gradient;
  double rate = 0.1;
  Index iterations = 10;
};

std::shared_ptr<const Stage> local_steps(const LocalStepsOptions& options);

}  // namespace physinv
