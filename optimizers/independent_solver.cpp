#include "optimizers/independent_solver.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "optimizers/steps/bfgs_update.h"

namespace physinv {

void IndependentSolver::open(BatchIn<double> x0) {
  BatchedSolver::open(x0);
  known_ = 0;
  knows_.assign(static_cast<std::size_t>(x0.cols()), 0);
  last_.resize(d_);
  last_gradient_.resize(d_);
}

/// goes_on(i, column, trial) of each active problem, which may write its next
/// trial point.
template <class F>
void IndependentSolver::keep_active(F&& goes_on) {
  accepted_.clear();
  known_ = 0;
  std::size_t kept = 0;
  for (std::size_t at = 0; at < active_.size(); ++at) {
    const Index i = active_[at];
    // Never ahead of `at`: this column's point has been used by then.
    double* trial = trial_.col(static_cast<Index>(kept)).data();
    if (goes_on(i, static_cast<Index>(at), trial)) active_[kept++] = i;
  }
  active_.resize(kept);
}

void IndependentSolver::take(VectorIn<double> loss, BatchIn<double> gradient) {
  keep_active([&](Index i, Index at, double* trial) {
    knows_[static_cast<std::size_t>(i)] = 0;
    last_ = trial_.col(at);
    return answer(i, {last_.data(), loss(at), gradient.col(at).data()}, trial);
  });
}

bool IndependentSolver::supply_known() {
  if (known_ == 0 || active_.empty()) return false;
  keep_active([&](Index i, Index at, double* trial) {
    char& knows = knows_[static_cast<std::size_t>(i)];
    if (knows == 0) {
      const double* point = trial_.col(at).data();
      if (point != trial) std::copy(point, point + d_, trial);
      return true;
    }
    knows = 0;
    ++skipped_trials_;
    last_ = x_.col(i);
    last_gradient_ = gradient_.col(i);
    return answer(i, {last_.data(), loss_(i), last_gradient_.data()}, trial);
  });
  return true;
}

/// Continues as long as the next trial point is the one at hand.
bool IndependentSolver::answer(Index i, const Point& at, double* trial) {
  bool goes_on = rounds_ == 0 ? open_run(i, at, trial) : advance(i, at, trial);
  if (known_point_ == KnownPoint::evaluate) return goes_on;
  const auto bytes = static_cast<std::size_t>(d_) * sizeof(double);
  while (goes_on && std::memcmp(trial, at.x, bytes) == 0) {
    if (!accepted_.empty() && accepted_.back() == i) {
      // The new iterate is to be seen before the next one.
      knows_[static_cast<std::size_t>(i)] = 1;
      ++known_;
      return true;
    }
    ++skipped_trials_;
    goes_on = advance(i, at, trial);
  }
  return goes_on;
}

bool IndependentSolver::open_run(Index i, const Point& at, double* trial) {
  loss_(i) = at.loss;
  std::copy(at.gradient, at.gradient + d_, gradient_.col(i).data());
  if (!std::isfinite(at.loss) || !dense::all_finite(d_, at.gradient))
    return finish(i, Status::nonfinite);
  accepted_.push_back(i);
  return begin(i, trial);
}

void IndependentSolver::accept(Index i, const Point& at) {
  std::copy(at.x, at.x + d_, x_.col(i).data());
  std::copy(at.gradient, at.gradient + d_, gradient_.col(i).data());
  loss_(i) = at.loss;
  ++iterations_[static_cast<std::size_t>(i)];
  accepted_.push_back(i);
}

}  // namespace physinv
