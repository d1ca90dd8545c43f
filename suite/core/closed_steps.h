/// Steps to a target that a problem has in closed form, the limits included
/// where a matrix is singular or its entries leave the range of numbers.
#pragma once

#include "suite/core/problem.h"

namespace physinv {

template <class T>
class ClosedSteps {
 public:
  virtual ~ClosedSteps() = default;
  /// dx = -H^-1 d loss / d x.
  virtual void newton_step(Point<T> at,
                           BatchIn<T> target,
                           BatchOut<T> dx) const = 0;
  /// dx = J^-1 (target - y).
  virtual void inverse_gradient_step(Point<T> at,
                                     BatchIn<T> target,
                                     BatchOut<T> dx) const = 0;
};

}  // namespace physinv
