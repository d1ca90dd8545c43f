/// Gradient descent with an adaptive step per problem (the gradient descent of
/// PhiML), run for many independent problems in lockstep.
///
/// One iteration from (x, L, g), best point b = x - eta g: up to `substeps`
/// times the step is multiplied by a factor (2 if b still descends, 1/2 if
/// not, max(exp(3 (ratio - 1/2)), 0.1) if b is worse than x, ratio being the
/// achieved over the predicted decrease) and the candidate replaces b if it is
/// better. The loop is shared: it ends when every active problem has either
/// improved on L or converged, so a problem's path does depend on the others
/// in its batch.
///
/// A start whose loss or gradient is not finite ends the problem before its
/// first iteration. A trial that is not finite, or its loss or gradient, counts
/// as L = +inf, g = 0. How it is used: batched_solver.h. `accepted` lists the
/// problems for which an iteration ended in the last round, moved or not (after
/// the first round all that began, none inside an iteration); an iteration that
/// was skipped because the gradient is zero is not announced. `evaluations` are
/// those of the algorithm as it is written, skipped ones included.
#pragma once

#include <vector>

#include "optimizers/batched_solver.h"

namespace physinv {

struct GradientDescentOptions {
  double first_step = 0.1;       ///< eta of the first iteration
  double step_tolerance = 1e-5;  ///< converged when a useless step is shorter
  Index maxiter = 1000;
  Index substeps = 10;
  /// Problems whose gradient is exactly zero converge at once; the evaluations
  /// that would show it are counted but not made. Results are the same.
  bool skip_zero_gradient = true;
};

/// Ends as `gtol` (converged), `linesearch` (diverged: no step lowers the
/// loss), `nonfinite` (no usable start), or `maxiter`.
class GradientDescent final : public BatchedSolver {
 public:
  explicit GradientDescent(const GradientDescentOptions& options = {})
      : options_(options) {}

  void start(BatchIn<double> x0) override;

 private:
  void take(VectorIn<double> loss, BatchIn<double> gradient) override;
  void open_runs(VectorIn<double> loss, BatchIn<double> gradient);
  void judge(VectorIn<double> loss, BatchIn<double> gradient);
  void begin_iteration();
  void propose(Index i, Index at);
  void first_trial(Index i, double loss, const double* gradient);
  void adapt(Index i);
  void substep(Index i, double loss, const double* gradient);
  bool settled(Index i) const;
  double step_tolerance_2() const;
  void end_iteration();

  GradientDescentOptions options_;
  Index iteration_ = 0, substep_ = 0;
  Batch<double> best_gradient_;
  Vector<double> eta_, test_, best_step_, best_loss_, zero_;
  std::vector<char> converged_;  // within this iteration
  std::vector<Index> flat_;      // whose gradient is zero
};

}  // namespace physinv
