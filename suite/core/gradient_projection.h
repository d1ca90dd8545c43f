/// What a problem may tell methods that invert the spectrum of its Jacobian.
#pragma once

#include "suite/core/batch.h"

namespace physinv {

/// Part of an observation's cotangent that no unknown can act on (y keeps a
/// norm, say). In exact arithmetic J^T ignores it; methods that invert J's
/// spectrum lose digits to it and may take it out first.
template <class T>
class GradientProjection {
 public:
  virtual ~GradientProjection() = default;
  /// y_bar, at the observations y, without that part.
  virtual void project(BatchIn<T> y, BatchOut<T> y_bar) const = 0;
};

}  // namespace physinv
