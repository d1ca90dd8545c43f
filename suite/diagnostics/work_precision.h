/// One point of a work-precision diagram: how far one configuration of a
/// problem is from a reference, and what a forward pass costs.
///
/// Every iteration is one forward pass of all samples, so that the curve's
/// seconds hold the time of each. Array `error` (1 x samples): |y - y_ref| /
/// |y_ref|, y_ref the reference's observation in double; -1 where y is not
/// finite.
#pragma once

#include <memory>
#include <string>

#include "suite/core/curve.h"
#include "suite/core/method.h"

namespace physinv {

struct WorkPrecisionOptions {
  std::string name;  ///< of the stage
  ProblemRecipe problem, reference;
  Index repetitions = 10;
};

std::shared_ptr<const Stage> work_precision(WorkPrecisionOptions options);

/// Seconds of the fastest repetition on record; 0 for none.
double fastest_repetition(const Curve& curve);

}  // namespace physinv
