#include "optimizers/gradient_descent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizers/steps/bfgs_update.h"
#include "suite/core/check.h"
#include "suite/core/math.h"

namespace physinv {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

void check(const GradientDescentOptions& o) {
  SUITE_CHECK(o.first_step > 0 && o.first_step < kInf,
              "gradient descent: the first step has a length");
  SUITE_CHECK(
      o.step_tolerance >= 0 && o.maxiter >= 0,
      "gradient descent: step_tolerance, maxiter are numbers from 0 on");
  SUITE_CHECK(o.substeps > 0, "an iteration needs a sub-step");
}

}  // namespace

void GradientDescent::start(BatchIn<double> x0) {
  const Index n = x0.cols();
  d_ = x0.rows();
  SUITE_CHECK(d_ > 0, "gradient descent needs unknowns");
  check(options_);
  rounds_ = iteration_ = substep_ = 0;
  skipped_ = skipped_trials_ = 0;
  starting_ = true;
  x_ = x0;
  trial_ = x0;
  gradient_.setZero(d_, n);
  best_gradient_.setZero(d_, n);
  zero_.setZero(d_);
  loss_.setConstant(n, kInf);
  best_loss_.setConstant(n, kInf);
  eta_.setConstant(n, options_.first_step);
  test_ = best_step_ = eta_;
  converged_.assign(at(n), 0);
  status_.assign(at(n), Status::maxiter);
  iterations_.assign(at(n), 0);
  evaluations_.assign(at(n), 0);
  flat_.clear();
  flat_.reserve(at(n));
  accepted_.clear();
  accepted_.reserve(at(n));
  active_.clear();
  active_.reserve(at(n));
  for (Index i = 0; i < n; ++i) {
    if (dense::all_finite(d_, x_.col(i).data())) {
      trial_.col(static_cast<Index>(active_.size())) = x_.col(i);
      active_.push_back(i);
    } else {
      status_[at(i)] = Status::nonfinite;
    }
  }
}

void GradientDescent::supply(VectorIn<double> loss, BatchIn<double> gradient) {
  const auto m = static_cast<Index>(active_.size());
  SUITE_CHECK(loss.size() == m && gradient.cols() == m && gradient.rows() == d_,
              "one loss and one gradient per active problem");
  ++rounds_;
  skipped_ += at(x_.cols() - m) - flat_.size();
  skipped_trials_ += flat_.size();
  for (const Index i : flat_) ++evaluations_[at(i)];
  accepted_.clear();
  bool done = true;
  for (Index k = 0; k < m; ++k) {
    const Index i = active_[at(k)];
    const double* g = gradient.col(k).data();
    double l = loss(k);
    if (!std::isfinite(l) || !dense::all_finite(d_, g) ||
        !dense::all_finite(d_, trial_.col(k).data()))
      l = kInf, g = zero_.data();
    ++evaluations_[at(i)];
    if (starting_) {
      loss_(i) = l;
      std::copy(g, g + d_, gradient_.col(i).data());
    } else if (substep_ == 0) {
      first_trial(i, l, g);
    } else {
      substep(i, l, g);
    }
    done &= settled(i);
  }
  if (starting_) {
    accepted_ = active_;
    starting_ = false;
    begin_iteration();
  } else if (substep_ > 0 && (done || substep_ == options_.substeps)) {
    end_iteration();
    begin_iteration();
  } else {
    ++substep_;
    for (Index k = 0; k < m; ++k) {
      adapt(active_[at(k)]);
      propose(active_[at(k)], k);
    }
  }
}

/// Opens the next iteration for the active problems and proposes its first
/// trials. Flat problems need none: every trial is x itself, so they converge
/// in the first sub-step and then only wait for the others.
void GradientDescent::begin_iteration() {
  flat_.clear();
  if (iteration_ == options_.maxiter) return active_.clear();
  ++iteration_;
  substep_ = 0;
  const bool skip = options_.skip_zero_gradient && step_tolerance_2() > 0;
  std::size_t kept = 0;
  for (const Index i : active_) {
    converged_[at(i)] = 0;
    test_(i) = best_step_(i) = eta_(i);
    const bool flat = dense::max_abs(d_, gradient_.col(i).data()) == 0;
    if (flat && skip) {
      flat_.push_back(i);
    } else {
      propose(i, static_cast<Index>(kept));
      active_[kept++] = i;
    }
  }
  active_.resize(kept);
  if (!active_.empty() || flat_.empty()) return;
  // Nobody to wait for: the first trial and one sub-step.
  for (const Index i : flat_) evaluations_[at(i)] += 2;
  skipped_trials_ += 2 * flat_.size();
  end_iteration();
}

void GradientDescent::propose(Index i, Index column) {
  for (Index j = 0; j < d_; ++j)
    trial_(j, column) = x_(j, i) - test_(i) * gradient_(j, i);
}

void GradientDescent::first_trial(Index i,
                                  double loss,
                                  const double* gradient) {
  best_loss_(i) = loss;
  best_step_(i) = test_(i);
  std::copy(gradient, gradient + d_, best_gradient_.col(i).data());
}

/// Lengthens or shortens the test step, judging by the best point so far.
void GradientDescent::adapt(Index i) {
  const double* g = gradient_.col(i).data();
  const double step = best_step_(i);
  double factor = 0.5;
  if (best_loss_(i) > loss_(i)) {
    const double predicted = step * dense::dot(d_, g, g);  // -g.(b - x)
    const double ratio =
        predicted == 0 ? 0 : (loss_(i) - best_loss_(i)) / predicted;
    factor = std::max(math::exp(3 * (ratio - 0.5)), 0.1);
  } else if (-step * dense::dot(d_, best_gradient_.col(i).data(), g) < 0) {
    factor = 2;
  }
  test_(i) *= factor;
}

void GradientDescent::substep(Index i, double loss, const double* gradient) {
  if (loss < best_loss_(i)) return first_trial(i, loss, gradient);
  const double* g = gradient_.col(i).data();
  const double moved = test_(i) * test_(i) * dense::dot(d_, g, g);
  if (moved < step_tolerance_2()) converged_[at(i)] = 1;
}

bool GradientDescent::settled(Index i) const {
  return converged_[at(i)] != 0 || best_loss_(i) < loss_(i);
}

double GradientDescent::step_tolerance_2() const {
  return options_.step_tolerance * options_.step_tolerance;
}

/// Moves to the best points and drops what converged or diverged.
void GradientDescent::end_iteration() {
  for (const Index i : flat_) {
    ++iterations_[at(i)];
    status_[at(i)] = loss_(i) < kInf ? Status::gtol : Status::nonfinite;
  }
  std::size_t kept = 0;
  for (const Index i : active_) {
    accepted_.push_back(i);
    ++iterations_[at(i)];
    const bool worse = best_loss_(i) > loss_(i);
    if (!worse) {
      for (Index j = 0; j < d_; ++j)
        x_(j, i) -= best_step_(i) * gradient_(j, i);
      loss_(i) = best_loss_(i);
      gradient_.col(i) = best_gradient_.col(i);
    }
    eta_(i) = best_step_(i);
    if (converged_[at(i)] != 0) {
      status_[at(i)] = loss_(i) < kInf ? Status::gtol : Status::nonfinite;
    } else if (worse) {
      status_[at(i)] = Status::linesearch;
    } else {
      active_[kept++] = i;
    }
  }
  active_.resize(kept);
  flat_.clear();
}

}  // namespace physinv
