/// Plain steps of fixed rate that differ in what they know of the solver
/// (Physics-based deep learning, chapter "Scale-invariance and inversion"):
///
///   gradient           x -= rate d loss / d x, or any first-order rule
///   newton             x -= rate H^-1 d loss / d x
///   inverse_gradient   x += J^-1 dy,        dy = rate (y* - y)
///   inverse_simulator  x  = P^-1(y + dy; x)
///   inverse_search     the same, P^-1 by a NumericInverse, in double always
///
/// There is no line search. H^-1 and J^-1 are the problem's ClosedSteps if it
/// has them; otherwise a direction that H or J does not see, its eigenvalue or
/// pivot zero but for rounding, stays where it is: up to d eps of the largest,
/// with eps of the stage's precision (training/newton.h). Problems are
/// independent of each other. A step that is not finite is not taken, and ends
/// its problem with status nonfinite; with all problems ended, the stage has
/// diverged.
///
/// Array `path`: the first problems' x below each other (unknowns times
/// `LocalStepsOptions::paths`, or fewer), a column for each step, the start
/// first.
#pragma once

#include <memory>
#include <optional>

#include "optimizers/numeric_inverse.h"
#include "optimizers/steps/rule.h"
#include "suite/core/method.h"

namespace physinv {

enum class LocalStep : std::uint8_t {
  gradient,
  newton,
  inverse_gradient,
  inverse_simulator,
  inverse_search
};
std::string_view to_string(LocalStep step);

struct LocalStepsOptions {
  LocalStep step = LocalStep::gradient;
  double rate = 0.1;
  Index iterations = 10;
  Index paths = 0;  ///< none unless somebody reads them
  NumericInverseOptions search = {};
  /// Of gradient steps, instead of `rate`; it works number by number.
  std::optional<StepOptions> rule = {};

  auto fields() const {
    return std::tuple{field("algorithm", step),
                      only_if(!rule, field("rate", rate)),
                      field("search", search),
                      if_changed(field("paths", paths)),
                      field("rule", rule),
                      implied(iterations)};
  }
};

/// Stage `solve`.
std::shared_ptr<const Stage> local_steps(const LocalStepsOptions& options);

}  // namespace physinv
