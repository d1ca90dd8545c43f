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
/// A trial that is not finite, or its loss or gradient, counts as L = +inf, g =
/// 0. Driven like `Bfgs`: start, then active/points/supply while pending, or
/// drive() of drive.h, whose observer is called after every iteration.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/stop.h"

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

class GradientDescent {
 public:
  explicit GradientDescent(const GradientDescentOptions& options = {})
      : options_(options) {}

  /// Begins one run per column of x0 (d x n). A column that is not finite ends
  /// at once, as it is.
  void start(BatchIn<double> x0);

  bool pending() const { return !active_.empty(); }
  /// Problems that wait for an evaluation, ascending.
  std::span<const Index> active() const { return active_; }
  /// Where they want it, d x active().size(), in the same order.
  Eigen::Ref<const Batch<double>> points() const {
    return trial_.leftCols(static_cast<Index>(active_.size()));
  }
  void supply(VectorIn<double> loss, BatchIn<double> gradient);
  /// Ends what is still pending, with status `maxiter`.
  void halt() { active_.clear(); }

  /// Problems for which an iteration ended in the last round, moved or not
  /// (after the first round all that began, none inside an iteration). An
  /// iteration that was skipped because the gradient is zero is not announced.
  std::span<const Index> accepted() const { return accepted_; }

  const Batch<double>& x() const { return x_; }
  const Vector<double>& loss() const { return loss_; }  ///< +inf: not finite
  /// `gtol` = converged, `linesearch` = diverged (no step lowers the loss),
  /// `nonfinite` = no usable start, `maxiter`.
  const std::vector<Status>& status() const { return status_; }
  const std::vector<Index>& iterations() const { return iterations_; }
  /// As the algorithm is written, skipped ones included.
  const std::vector<Index>& evaluations() const { return evaluations_; }

  Index rounds() const { return rounds_; }
  /// Evaluations of zero gradients that were not made.
  std::uint64_t skipped_trials() const { return skipped_trials_; }
  /// Evaluations a fixed batch would have made of finished problems.
  std::uint64_t skipped_evaluations() const { return skipped_; }

 private:
  void begin_iteration();
  void propose(Index i, Index at);
  void first_trial(Index i, double loss, const double* gradient);
  void adapt(Index i);
  void substep(Index i, double loss, const double* gradient);
  bool settled(Index i) const;
  double step_tolerance_2() const;
  void end_iteration();

  GradientDescentOptions options_;
  Index d_ = 0, rounds_ = 0, iteration_ = 0, substep_ = 0;
  bool starting_ = true;
  std::uint64_t skipped_ = 0, skipped_trials_ = 0;
  Batch<double> x_, gradient_, best_gradient_, trial_;
  Vector<double> loss_, eta_, test_, best_step_, best_loss_, zero_;
  std::vector<char> converged_;  // within this iteration
  std::vector<Status> status_;
  std::vector<Index> iterations_, evaluations_, active_, flat_, accepted_;
};

}  // namespace physinv
