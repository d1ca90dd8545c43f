#include "optimizers/batched_solver.h"

#include <limits>

#include "optimizers/steps/bfgs_update.h"
#include "suite/core/check.h"

namespace physinv {

void BatchedSolver::open(BatchIn<double> x0) {
  const Index n = x0.cols();
  const auto count = static_cast<std::size_t>(n);
  d_ = x0.rows();
  SUITE_CHECK(d_ > 0, "a solver needs at least one unknown");
  rounds_ = 0;
  skipped_ = skipped_trials_ = 0;
  x_ = x0;
  trial_.resize(d_, n);
  gradient_.setZero(d_, n);
  loss_.setConstant(n, std::numeric_limits<double>::quiet_NaN());
  status_.assign(count, Status::maxiter);
  iterations_.assign(count, 0);
  evaluations_.assign(count, 0);
  accepted_.clear();
  accepted_.reserve(count);
  active_.clear();
  active_.reserve(count);
  for (Index i = 0; i < n; ++i) {
    if (dense::all_finite(d_, x_.col(i).data())) {
      trial_.col(static_cast<Index>(active_.size())) = x_.col(i);
      active_.push_back(i);
    } else {
      finish(i, Status::nonfinite);
    }
  }
}

void BatchedSolver::supply(VectorIn<double> loss, BatchIn<double> gradient) {
  const auto m = static_cast<Index>(active_.size());
  SUITE_CHECK(loss.size() == m && gradient.cols() == m && gradient.rows() == d_,
              "there must be one loss and one gradient per active problem");
  skipped_ += static_cast<std::uint64_t>(x_.cols() - m);
  for (const Index i : active_) ++evaluations_[static_cast<std::size_t>(i)];
  accepted_.clear();
  take(loss, gradient);
  ++rounds_;
}

bool BatchedSolver::finish(Index i, Status status) {
  status_[static_cast<std::size_t>(i)] = status;
  return false;
}

}  // namespace physinv
