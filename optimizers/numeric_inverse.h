/// A local inverse of any problem, by search: the x at which L-BFGS-B ends that
/// minimizes the problem's loss to y from a guess on.
///
/// Gradients are exact, or differences (f(x + h) - f(x)) / h one unknown at a
/// time, as SciPy's where none are given: these know a minimum to about h.
/// From a guess that is not finite, or its loss, there is none: x is NaN.
#pragma once

#include "optimizers/lbfgsb.h"
#include "suite/core/counted_problem.h"
#include "suite/core/options.h"

namespace physinv {

struct NumericInverseOptions {
  double difference = 0;  ///< h; 0: exact gradients
  double pgtol = 1e-5;    ///< of L-BFGS-B, its defaults
  double ftol = 2.2204460492503131e-09;

  auto fields() const {
    return std::tuple{field("difference", difference),
                      field("pgtol", pgtol),
                      field("ftol", ftol)};
  }
};

class NumericInverse {
 public:
  /// `problem` has a Vjp if gradients are to be exact.
  NumericInverse(CountedProblem<double> problem,
                 const NumericInverseOptions& options);

  void invert(BatchIn<double> y,
              BatchIn<double> given,
              BatchIn<double> x_guess,
              BatchOut<double> x);

  Counts counts() const;
  std::size_t bytes() const { return problem_.bytes(); }

 private:
  void losses(BatchIn<double> x, VectorOut<double> loss);
  void exact(BatchIn<double> x,
             VectorOut<double> loss,
             BatchOut<double> gradient);
  void differences(BatchIn<double> x,
                   VectorOut<double> loss,
                   BatchOut<double> gradient);

  CountedProblem<double> problem_;
  NumericInverseOptions options_;
  Lbfgsb solver_;
  Batch<double> given_, target_, y_, y_bar_, moved_;  // of the active problems
  Vector<double> moved_loss_;
  Counts saved_;
};

}  // namespace physinv
