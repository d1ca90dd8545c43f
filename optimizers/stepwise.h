/// Solvers that move all examples of a case at once, update by update, and have
/// no line search: gradients, Newton, local inverses.
#pragma once

#include <vector>

#include "optimizers/metrics.h"
#include "suite/core/method.h"

namespace physinv {

class StepwiseSolver {
 public:
  virtual ~StepwiseSolver() = default;
  /// What the first step would allocate and fill.
  virtual void warm_up() {}
  virtual void step() = 0;
  /// The present estimate. Not part of its work.
  virtual void estimate(BatchOut<double> x) = 0;
  /// Adds statuses, counts, arrays and bytes to what has run its iterations.
  virtual void export_to(Outcome& /*out*/) {}
};

/// Steps as long as the probe says, which keeps clock and curve. Every number
/// of the arrays left is finite.
Outcome run_steps(StepwiseSolver& solver, StageRun& run);
/// Arrays left as well: `mean_loss` (1 x points of the curve, over the case's
/// problems), and `metrics` if there are any, whose `parameters` are empty.
Outcome run_steps(StepwiseSolver& solver,
                  StageRun& run,
                  const Metrics& metrics);

/// Examples that end alone: an update that is not finite is not taken, and ends
/// its example with status nonfinite.
class Examples {
 public:
  explicit Examples(Index count);
  bool running(Index i) const;
  bool none_running() const;
  /// Example i took its update, or ends.
  void count(Index i) { ++iterations_(i); }
  void end(Index i);
  void export_to(Outcome& out) const;

 private:
  std::vector<Status> status_;
  Vector<double> iterations_;
};

}  // namespace physinv
