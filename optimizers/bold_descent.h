/// Gradient descent of a bold driver: longer steps while the loss falls, half
/// the step where it does not, every problem by itself (Navier-Stokes
/// experiment of the JPO paper; the adaptive rule of its library,
/// gradient_descent.h, lets problems of a batch wait for each other).
///
///   trial = x - a g / max(1, |g|)
///   L falls: x = trial, a *= longer    otherwise: a *= shorter
///
/// Where trial, loss or gradient are not finite, nothing falls. How it is used:
/// batched_solver.h.
#pragma once

#include "optimizers/independent_solver.h"

namespace physinv {

struct BoldDescentOptions {
  double first_step = 0.1;  ///< a
  double longer = 1.5, shorter = 0.5;
  Index evaluations = 100;  ///< trials
};

/// Ends as `gtol` (a gradient of zero), `nonfinite`, or `maxiter`.
class BoldDescent final : public IndependentSolver {
 public:
  explicit BoldDescent(const BoldDescentOptions& options = {})
      : IndependentSolver(KnownPoint::evaluate), options_(options) {}

  void start(BatchIn<double> x0) override;

 private:
  bool begin(Index i, double* trial) override;
  bool advance(Index i, const Point& at, double* trial) override;

  BoldDescentOptions options_;
  Vector<double> step_;
};

}  // namespace physinv
