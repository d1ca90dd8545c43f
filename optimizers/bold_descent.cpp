#include "optimizers/bold_descent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizers/steps/bfgs_update.h"
#include "suite/core/check.h"

namespace physinv {

void BoldDescent::start(BatchIn<double> x0) {
  const BoldDescentOptions& o = options_;
  SUITE_CHECK(std::isfinite(o.first_step) && o.first_step > 0,
              "a bold driver: the first step has a length");
  SUITE_CHECK(0 < o.shorter && o.shorter < 1 && 1 <= o.longer &&
                  std::isfinite(o.longer),
              "a bold driver: 0 < shorter < 1 <= longer");
  SUITE_CHECK(o.evaluations >= 0,
              "a bold driver: evaluations is a number from 0 on");
  const Index n = x0.cols();
  const auto count = static_cast<std::size_t>(n);
  skipped_ = 0;
  x_ = x0;
  trial_ = x0;
  gradient_.setZero(x0.rows(), n);
  loss_.setConstant(n, std::numeric_limits<double>::infinity());
  step_.setConstant(n, options_.first_step);
  status_.assign(count, Status::maxiter);
  iterations_.assign(count, 0);
  evaluations_.assign(count, 0);
  accepted_.clear();
  accepted_.reserve(count);
  active_.clear();
  active_.reserve(count);
  for (Index i = 0; i < n; ++i) {
    if (dense::all_finite(x_.rows(), x_.col(i).data())) {
      trial_.col(static_cast<Index>(active_.size())) = x_.col(i);
      active_.push_back(i);
    } else {
      status_[static_cast<std::size_t>(i)] = Status::nonfinite;
    }
  }
}

void BoldDescent::supply(VectorIn<double> loss, BatchIn<double> gradient) {
  const auto m = static_cast<Index>(active_.size());
  SUITE_CHECK(
      loss.size() == m && gradient.cols() == m && gradient.rows() == x_.rows(),
      "one loss and one gradient per active problem");
  skipped_ += static_cast<std::uint64_t>(x_.cols() - m);
  accepted_.clear();
  std::size_t kept = 0;
  for (Index at = 0; at < m; ++at) {
    const Index i = active_[static_cast<std::size_t>(at)];
    if (!take(i, at, loss(at), gradient.col(at))) continue;
    const double* g = gradient_.col(i).data();
    const double size = dense::norm(x_.rows(), g);
    const double a = -step_(i) / std::max(1.0, size);
    for (Index j = 0; j < x_.rows(); ++j)
      trial_(j, static_cast<Index>(kept)) = std::fma(a, g[j], x_(j, i));
    active_[kept++] = i;
  }
  active_.resize(kept);
}

/// An evaluation came back; false if it was the problem's last.
bool BoldDescent::take(Index i,
                       Index at,
                       double loss,
                       VectorIn<double> gradient) {
  const auto k = static_cast<std::size_t>(i);
  const bool first = evaluations_[k]++ == 0;
  const bool usable = std::isfinite(loss) &&
                      dense::all_finite(gradient.size(), gradient.data()) &&
                      dense::all_finite(x_.rows(), trial_.col(at).data());
  if (usable && loss < loss_(i)) {
    x_.col(i) = trial_.col(at);
    gradient_.col(i) = gradient;
    loss_(i) = loss;
    accepted_.push_back(i);
    if (!first) ++iterations_[k], step_(i) *= options_.longer;
  } else if (first) {
    status_[k] = Status::nonfinite;
    return false;
  } else {
    step_(i) *= options_.shorter;
  }
  if (dense::max_abs(x_.rows(), gradient_.col(i).data()) == 0) {
    status_[k] = Status::gtol;
    return false;
  }
  return evaluations_[k] <= options_.evaluations;
}

}  // namespace physinv
