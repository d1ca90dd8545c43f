#include "optimizers/bfgs.h"

#include <limits>

#include "optimizers/steps/bfgs_update.h"
#include "suite/core/check.h"

namespace physinv {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void check(const BfgsOptions& o) {
  SUITE_CHECK(o.gtol >= 0 && o.stall >= 0 && o.maxiter >= 0,
              "BFGS: gtol, stall and maxiter must not be negative");
  const LineSearchOptions& s = o.search;
  SUITE_CHECK(0 < s.decrease && s.decrease < s.curvature && s.curvature < 1,
              "a line search needs 0 < decrease < curvature < 1");
  SUITE_CHECK(s.xtol >= 0 && 0 <= s.min_step && s.min_step <= s.max_step,
              "a line search needs xtol >= 0 and 0 <= min_step <= max_step");
  SUITE_CHECK(s.max_evaluations > 0 && s.max_doublings >= 0 &&
                  s.max_zooms > 0 && s.max_together > 0,
              "a line search needs at least one evaluation");
}

}  // namespace

void Bfgs::start(BatchIn<double> x0) {
  check(options_);
  open(x0);
  const Index n = x0.cols();
  direction_.setZero(d_, n);
  hessian_.resize(d_ * d_, n);
  earlier_.resize(kStallSteps, n);
  previous_loss_.setZero(n);
  step_.resize(d_);
  change_.resize(d_);
  scratch_.resize(d_);
  searches_.resize(static_cast<std::size_t>(n));
}

bool Bfgs::begin(Index i, double* trial) {
  const double* g = gradient_.col(i).data();
  previous_loss_(i) = loss_(i) + dense::norm(d_, g) / 2;
  earlier_(0, i) = loss_(i);
  if (dense::max_abs(d_, g) <= options_.gtol) return finish(i, Status::gtol);
  dense::set_identity(d_, hessian(i));
  return iterate(i, trial);
}

/// One move of the line search, perhaps the last.
bool Bfgs::advance(Index i, const Point& at, double* trial) {
  LineSearch& line = searches_[static_cast<std::size_t>(i)];
  const double* p = direction_.col(i).data();
  const auto next =
      line.supply(options_.search, at.loss, dense::dot(d_, at.gradient, p));
  if (next != LineSearch::Next::accept) return search(i, next, trial);

  const double* g = gradient_.col(i).data();
  for (Index j = 0; j < d_; ++j) step_(j) = line.step() * p[j];
  for (Index j = 0; j < d_; ++j) change_(j) = at.gradient[j] - g[j];
  previous_loss_(i) = loss_(i);
  accept(i, at);
  if (dense::max_abs(d_, g) <= options_.gtol) return finish(i, Status::gtol);
  if (line.step() * dense::norm(d_, p) == 0) return finish(i, Status::gtol);
  if (stalls(i)) return finish(i, Status::ftol);
  if (iterations_[static_cast<std::size_t>(i)] < options_.maxiter) {
    dense::bfgs_update(
        d_, step_.data(), change_.data(), hessian(i), scratch_.data());
  }
  return iterate(i, trial);
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
  const auto next = searches_[static_cast<std::size_t>(i)].start(
      options_.search, loss_(i), slope, first_step(i, slope));
  return search(i, next, trial);
}

/// Of the line search, in lengths of its direction.
double Bfgs::first_step(Index i, double slope) const {
  const bool begins = iterations_[static_cast<std::size_t>(i)] == 0;
  if (begins && options_.first_trial != FirstTrial::scipy)
    return first_trial(options_.first_trial,
                       dense::norm(d_, gradient_.col(i).data()));
  const double first = 2.02 * (loss_(i) - previous_loss_(i)) / slope;
  return !(first < 1) || first < 0 || slope == 0 ? 1 : first;
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

}  // namespace physinv
