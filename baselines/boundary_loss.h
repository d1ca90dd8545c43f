/// The wall that keeps the neural adjoint near its training data:
///
///   B(x) = sum_j softplus(gamma z_j) / gamma,
///   z_j = max(x_j - hi_j, lo_j - x_j) / (hi_j - lo_j),
///
/// with lo and hi the smallest and largest training value of unknown j.
/// Finite for every finite x, however far outside.
#pragma once

#include "suite/core/batch.h"

namespace physinv {

class BoundaryLoss {
 public:
  /// lo < hi for every unknown.
  BoundaryLoss(VectorIn<double> lo, VectorIn<double> hi, double gamma = 20);

  /// The range of the columns of `samples`, unknowns x count.
  static BoundaryLoss over(BatchIn<double> samples, double gamma = 20);

  /// loss_i += weight B(x_i), gradient_i += weight dB/dx_i.
  void add(BatchIn<double> x,
           double weight,
           VectorOut<double> loss,
           BatchOut<double> gradient) const;

 private:
  Vector<double> lo_, hi_;
  double gamma_;
};

}  // namespace physinv
