#include "optimizers/bfgs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "optimizers/steps/bfgs_update.h"
#include "suite/core/check.h"

namespace physinv {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void Bfgs::start(BatchIn<double> x0) {
  const Index n = x0.cols();
  const auto count = static_cast<std::size_t>(n);
  d_ = x0.rows();
  SUITE_CHECK(d_ > 0, "BFGS needs unknowns");
  rounds_ = 0;
  skipped_ = 0;
  x_ = x0;
  trial_ = x0;
  gradient_.setZero(d_, n);
  direction_.setZero(d_, n);
  hessian_.resize(d_ * d_, n);
  earlier_.resize(kStallSteps, n);
  loss_.setConstant(n, kNan);
  previous_loss_.setZero(n);
  step_.resize(d_);
  change_.resize(d_);
  scratch_.resize(d_);
  searches_.resize(count);
  status_.assign(count, Status::maxiter);
  iterations_.assign(count, 0);
  evaluations_.assign(count, 0);
  accepted_.clear();
  accepted_.reserve(count);
  active_.resize(count);
  std::iota(active_.begin(), active_.end(), Index{0});
}

void Bfgs::supply(VectorIn<double> loss, BatchIn<double> gradient) {
  const auto m = static_cast<Index>(active_.size());
  SUITE_CHECK(loss.size() == m && gradient.cols() == m && gradient.rows() == d_,
              "one loss and one gradient per active problem");
  skipped_ += static_cast<std::uint64_t>(x_.cols() - m);
  accepted_.clear();
  std::size_t kept = 0;
  for (Index at = 0; at < m; ++at) {
    const Index i = active_[static_cast<std::size_t>(at)];
    // Never ahead of `at`: this column's point has been used by then.
    double* trial = trial_.col(static_cast<Index>(kept)).data();
    ++evaluations_[static_cast<std::size_t>(i)];
    const double* g = gradient.col(at).data();
    const bool goes_on = rounds_ == 0 ? begin(i, loss(at), g, trial)
                                      : advance(i, at, loss(at), g, trial);
    if (goes_on) active_[kept++] = i;
  }
  active_.resize(kept);
  ++rounds_;
}

bool Bfgs::begin(Index i, double loss, const double* gradient, double* trial) {
  loss_(i) = loss;
  std::copy(gradient, gradient + d_, gradient_.col(i).data());
  if (!std::isfinite(loss) || !dense::all_finite(d_, gradient))
    return finish(i, Status::nonfinite);
  accepted_.push_back(i);
  previous_loss_(i) = loss + dense::norm(d_, gradient) / 2;
  earlier_(0, i) = loss;
  if (dense::max_abs(d_, gradient) <= options_.gtol)
    return finish(i, Status::gtol);
  dense::set_identity(d_, hessian(i));
  return iterate(i, trial);
}

/// An evaluation came back: one move of the line search, perhaps the last.
bool Bfgs::advance(
    Index i, Index at, double loss, const double* gradient, double* trial) {
  LineSearch& line = searches_[static_cast<std::size_t>(i)];
  const double* p = direction_.col(i).data();
  const auto next =
      line.supply(options_.search, loss, dense::dot(d_, gradient, p));
  if (next != LineSearch::Next::accept) return search(i, next, trial);

  for (Index j = 0; j < d_; ++j) step_(j) = line.step() * p[j];
  move(i, trial_.col(at).data(), loss, gradient);
  if (dense::max_abs(d_, gradient) <= options_.gtol)
    return finish(i, Status::gtol);
  if (line.step() * dense::norm(d_, p) == 0) return finish(i, Status::gtol);
  if (stalls(i)) return finish(i, Status::gtol);
  if (iterations_[static_cast<std::size_t>(i)] < options_.maxiter) {
    dense::bfgs_update(
        d_, step_.data(), change_.data(), hessian(i), scratch_.data());
  }
  return iterate(i, trial);
}

/// Takes over the accepted point; change_ becomes g' - g.
void Bfgs::move(Index i,
                const double* to,
                double loss,
                const double* gradient) {
  double* x = x_.col(i).data();
  double* g = gradient_.col(i).data();
  for (Index j = 0; j < d_; ++j) change_(j) = gradient[j] - g[j];
  std::copy(to, to + d_, x);
  std::copy(gradient, gradient + d_, g);
  previous_loss_(i) = loss_(i);
  loss_(i) = loss;
  ++iterations_[static_cast<std::size_t>(i)];
  accepted_.push_back(i);
}

/// Starts the next iteration: direction, first step, first trial point.
bool Bfgs::iterate(Index i, double* trial) {
  if (iterations_[static_cast<std::size_t>(i)] >= options_.maxiter)
    return finish(i, Status::maxiter);
  double* p = direction_.col(i).data();
  const double* g = gradient_.col(i).data();
  dense::multiply(d_, hessian(i), g, p);
  for (Index j = 0; j < d_; ++j) p[j] = -p[j];
  const double slope = dense::dot(d_, g, p);
  double first = 2.02 * (loss_(i) - previous_loss_(i)) / slope;
  if (!(first < 1) || first < 0 || slope == 0) first = 1;
  const auto next = searches_[static_cast<std::size_t>(i)].start(
      options_.search, loss_(i), slope, first);
  return search(i, next, trial);
}

/// Turns a move of the line search into the next trial point or the end.
bool Bfgs::search(Index i, LineSearch::Next next, double* trial) {
  LineSearch& line = searches_[static_cast<std::size_t>(i)];
  const double* x = x_.col(i).data();
  const double* p = direction_.col(i).data();
  while (next == LineSearch::Next::evaluate) {
    for (Index j = 0; j < d_; ++j) trial[j] = x[j] + line.step() * p[j];
    if (dense::all_finite(d_, trial)) return true;
    // An overflowing point is never shown to the objective, which might find
    // it acceptable.
    next = line.supply(options_.search, kNan, kNan);
  }
  return finish(i,
                next == LineSearch::Next::nonfinite ? Status::nonfinite
                                                    : Status::linesearch);
}

bool Bfgs::stalls(Index i) {
  const Index k = iterations_[static_cast<std::size_t>(i)];
  double& before = earlier_(k % kStallSteps, i);
  const bool stalls =
      k >= kStallSteps && before - loss_(i) < options_.stall * before;
  before = loss_(i);
  return stalls;
}

bool Bfgs::finish(Index i, Status status) {
  status_[static_cast<std::size_t>(i)] = status;
  return false;
}

}  // namespace physinv
