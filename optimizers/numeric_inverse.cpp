#include "optimizers/numeric_inverse.h"

#include <cmath>
#include <limits>
#include <utility>

#include "optimizers/drive.h"
#include "suite/core/check.h"
#include "suite/core/option_check.h"

namespace physinv {

NumericInverse::NumericInverse(CountedProblem<double> problem,
                               const NumericInverseOptions& options)
    : problem_(std::move(problem)),
      options_(options),
      solver_({.pgtol = options.pgtol, .ftol = options.ftol}) {
  check_numbers<double>({{"difference", options.difference}});
  SUITE_CHECK(options.difference >= 0, "difference must not be negative");
}

void NumericInverse::invert(BatchIn<double> y,
                            BatchIn<double> given,
                            BatchIn<double> x_guess,
                            BatchOut<double> x) {
  drive(
      solver_,
      [&](std::span<const Index> active,
          BatchIn<double> points,
          VectorOut<double> loss,
          BatchOut<double> gradient) {
        given_ = given(Eigen::all, active);
        target_ = y(Eigen::all, active);
        if (options_.difference > 0) {
          differences(points, loss, gradient);
        } else {
          exact(points, loss, gradient);
        }
      },
      x_guess);
  x = solver_.x();
  for (Index i = 0; i < x.cols(); ++i)
    if (!std::isfinite(solver_.loss()(i)))
      x.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
  saved_[Counter::skipped_trials] += solver_.skipped_trials();
}

Counts NumericInverse::counts() const {
  Counts all = problem_.counts();
  all += saved_;
  return all;
}

void NumericInverse::losses(BatchIn<double> x, VectorOut<double> loss) {
  y_.resizeLike(target_);
  problem_.forward(x, given_, y_);
  problem_.loss(y_, target_, loss);
}

void NumericInverse::exact(BatchIn<double> x,
                           VectorOut<double> loss,
                           BatchOut<double> gradient) {
  y_.resizeLike(target_), y_bar_.resizeLike(target_);
  problem_.linearize(x, given_, y_);
  problem_.loss(y_, target_, loss);
  problem_.loss_gradient(y_, target_, y_bar_);
  problem_.pullback(y_bar_, gradient);
}

void NumericInverse::differences(BatchIn<double> x,
                                 VectorOut<double> loss,
                                 BatchOut<double> gradient) {
  losses(x, loss);
  moved_ = x;
  moved_loss_.resize(x.cols());
  for (Index j = 0; j < x.rows(); ++j) {
    moved_.row(j).array() += options_.difference;
    losses(moved_, moved_loss_);
    gradient.row(j) = (moved_loss_ - loss).transpose().array() /
                      (moved_.row(j) - x.row(j)).array();
    moved_.row(j) = x.row(j);
  }
}

}  // namespace physinv
