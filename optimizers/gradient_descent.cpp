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
              "gradient descent: first_step must be positive");
  SUITE_CHECK(
      o.step_tolerance >= 0 && o.maxiter >= 0,
      "gradient descent: step_tolerance and maxiter must not be negative");
  SUITE_CHECK(o.substeps > 0, "gradient descent: substeps must be positive");
}

}  // namespace

void GradientDescent::start(BatchIn<double> x0) {
  check(options_);
  open(x0);
  const Index n = x0.cols();
  iteration_ = substep_ = 0;
  best_gradient_.setZero(d_, n);
  zero_.setZero(d_);
  best_loss_.setConstant(n, kInf);
  eta_.setConstant(n, options_.first_step);
  test_ = best_step_ = eta_;
  converged_.assign(at(n), 0);
  flat_.clear();
  flat_.reserve(at(n));
}

void GradientDescent::take(VectorIn<double> loss, BatchIn<double> gradient) {
  if (rounds_ == 0) {
    open_runs(loss, gradient);
    return begin_iteration();
  }
  skipped_ -= flat_.size();
  skipped_trials_ += flat_.size();
  for (const Index i : flat_) ++evaluations_[at(i)];
  judge(loss, gradient);
  const bool done = std::all_of(
      active_.begin(), active_.end(), [this](Index i) { return settled(i); });
  if (substep_ > 0 && (done || substep_ == options_.substeps)) {
    end_iteration();
    begin_iteration();
  } else {
    ++substep_;
    for (std::size_t k = 0; k < active_.size(); ++k) {
      adapt(active_[k]);
      propose(active_[k], static_cast<Index>(k));
    }
  }
}

/// The starts came back. Those without a finite loss and gradient end.
void GradientDescent::open_runs(VectorIn<double> loss,
                                BatchIn<double> gradient) {
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const Index i = active_[k], column = static_cast<Index>(k);
    loss_(i) = loss(column);
    gradient_.col(i) = gradient.col(column);
    if (std::isfinite(loss_(i)) &&
        dense::all_finite(d_, gradient_.col(i).data()))
      accepted_.push_back(i);
    else
      finish(i, Status::nonfinite);
  }
  active_ = accepted_;
}

/// Notes what came back: of a first trial or a sub-step.
void GradientDescent::judge(VectorIn<double> loss, BatchIn<double> gradient) {
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const Index i = active_[k], column = static_cast<Index>(k);
    const double* g = gradient.col(column).data();
    double l = loss(column);
    if (!std::isfinite(l) || !dense::all_finite(d_, g) ||
        !dense::all_finite(d_, trial_.col(column).data()))
      l = kInf, g = zero_.data();
    if (substep_ == 0)
      first_trial(i, l, g);
    else
      substep(i, l, g);
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
  // Only flat problems are left: count their first trial and one sub-step.
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
    finish(i, Status::gtol);
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
      finish(i, Status::gtol);
    } else if (worse) {
      finish(i, Status::linesearch);
    } else {
      active_[kept++] = i;
    }
  }
  active_.resize(kept);
  flat_.clear();
}

}  // namespace physinv
