#include "baselines/boundary_loss.h"

#include <algorithm>
#include <cmath>

#include "suite/core/check.h"
#include "suite/core/math.h"

namespace physinv {

BoundaryLoss::BoundaryLoss(VectorIn<double> lo,
                           VectorIn<double> hi,
                           double gamma)
    : lo_(lo), hi_(hi), gamma_(gamma) {
  SUITE_CHECK(lo.size() == hi.size(), "there must be one range per unknown");
  SUITE_CHECK((lo.array() < hi.array()).all(),
              "every range must have a positive width");
  SUITE_CHECK(gamma > 0, "gamma must be positive");
}

BoundaryLoss BoundaryLoss::over(BatchIn<double> samples, double gamma) {
  SUITE_CHECK(samples.cols() > 1, "a range needs two samples");
  return BoundaryLoss(
      samples.rowwise().minCoeff(), samples.rowwise().maxCoeff(), gamma);
}

void BoundaryLoss::add(BatchIn<double> x,
                       double weight,
                       VectorOut<double> loss,
                       BatchOut<double> gradient) const {
  SUITE_CHECK(x.rows() == lo_.size(), "there must be one range per unknown");
  SUITE_CHECK(loss.size() == x.cols() && gradient.rows() == x.rows() &&
                  gradient.cols() == x.cols(),
              "there must be one loss and one gradient per column");
  for (Index i = 0; i < x.cols(); ++i) {
    double sum = 0;
    for (Index j = 0; j < x.rows(); ++j) {
      const double width = hi_(j) - lo_(j);
      const double above = x(j, i) - hi_(j), below = lo_(j) - x(j, i);
      const double t = gamma_ * (std::max(above, below) / width);
      const double e = math::exp(-std::abs(t));  // never overflows
      sum += std::max(t, 0.0) + math::log1p(e);
      const double sigma = (t < 0 ? e : 1.0) / (1.0 + e);
      // In the exact middle both walls pull alike.
      const double side = above > below ? 1 : above < below ? -1 : 0;
      gradient(j, i) += weight * (sigma * side / width);
    }
    loss(i) += weight * (sum / gamma_);
  }
}

}  // namespace physinv
