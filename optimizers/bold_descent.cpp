#include "optimizers/bold_descent.h"

#include <algorithm>
#include <cmath>

#include "optimizers/steps/bfgs_update.h"
#include "suite/core/check.h"

namespace physinv {

void BoldDescent::start(BatchIn<double> x0) {
  const BoldDescentOptions& o = options_;
  SUITE_CHECK(std::isfinite(o.first_step) && o.first_step > 0,
              "bold driver: first_step must be positive");
  SUITE_CHECK(0 < o.shorter && o.shorter < 1 && 1 <= o.longer &&
                  std::isfinite(o.longer),
              "bold driver: 0 < shorter < 1 <= longer must hold");
  SUITE_CHECK(o.evaluations >= 0,
              "bold driver: evaluations must not be negative");
  open(x0);
  step_.setConstant(x0.cols(), o.first_step);
}

/// The next trial from the iterate, unless the problem ends.
bool BoldDescent::begin(Index i, double* trial) {
  const double* g = gradient_.col(i).data();
  if (dense::max_abs(d_, g) == 0) return finish(i, Status::gtol);
  if (evaluations_[static_cast<std::size_t>(i)] > options_.evaluations)
    return finish(i, Status::maxiter);
  const double a = -step_(i) / std::max(1.0, dense::norm(d_, g));
  for (Index j = 0; j < d_; ++j) trial[j] = std::fma(a, g[j], x_(j, i));
  return true;
}

bool BoldDescent::advance(Index i, const Point& at, double* trial) {
  const bool usable = std::isfinite(at.loss) &&
                      dense::all_finite(d_, at.gradient) &&
                      dense::all_finite(d_, at.x);
  if (usable && at.loss < loss_(i)) {
    accept(i, at);
    step_(i) *= options_.longer;
  } else {
    step_(i) *= options_.shorter;
  }
  return begin(i, trial);
}

}  // namespace physinv
