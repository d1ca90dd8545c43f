/// What solvers share that run many independent problems together: they ask for
/// a batch of evaluations, one trial point of each unfinished problem, and are
/// given losses and gradients.
///
///   Bfgs solver(options);
///   solver.start(x0);                       // d x n, one problem per column
///   while (solver.pending()) {
///     objective(solver.active(), solver.points(), loss, gradient);
///     solver.supply(loss, gradient);
///     while (solver.supply_known()) {}
///   }
///
/// or, in one call, drive(solver, objective, x0, observer) of drive.h, or as a
/// stage of a method, minimize(solver, run, x0) of minimize.h.
///
/// A finished problem costs nothing more. A start that is not finite stays as
/// it is with status `nonfinite`, and is never shown to the objective.
///
/// A new solver overrides `start`, which calls `open`, and `take`; one whose
/// problems do not wait for each other derives from IndependentSolver.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/stop.h"

namespace physinv {

class BatchedSolver {
 public:
  virtual ~BatchedSolver() = default;

  /// Begins one run per column of x0 (d x n). Nothing allocates after it, nor
  /// in it if the size is that of an earlier run.
  virtual void start(BatchIn<double> x0) = 0;

  bool pending() const { return !active_.empty(); }
  /// Problems that wait for an evaluation, ascending.
  std::span<const Index> active() const { return active_; }
  /// Where they want it, d x active().size(), in the same order.
  Eigen::Ref<const Batch<double>> points() const {
    return trial_.leftCols(static_cast<Index>(active_.size()));
  }
  /// Losses and gradients at `points()`. A loss or gradient that is not finite
  /// marks a place that no problem moves to.
  void supply(VectorIn<double> loss, BatchIn<double> gradient);
  /// Problems whose next trial point is their iterate, which is known, continue
  /// without an evaluation. False if there are none; what they accept is
  /// `accepted` then. Without the call they are evaluated once more.
  virtual bool supply_known() { return false; }
  /// Ends what is still pending, with status `maxiter`.
  void halt() { active_.clear(); }

  /// Problems that accepted a new iterate in the last round; in the first
  /// round those whose start is usable (iteration 0).
  std::span<const Index> accepted() const { return accepted_; }

  // Per problem; valid at any time after the first round.
  const Batch<double>& x() const { return x_; }  ///< last accepted iterate
  const Vector<double>& loss() const { return loss_; }
  const Batch<double>& gradient() const { return gradient_; }
  /// See the solver; `maxiter` also while running.
  const std::vector<Status>& status() const { return status_; }
  const std::vector<Index>& iterations() const { return iterations_; }
  /// As the algorithm counts them.
  const std::vector<Index>& evaluations() const { return evaluations_; }

  Index rounds() const { return rounds_; }
  /// Evaluations a fixed batch would have made of finished problems.
  std::uint64_t skipped_evaluations() const { return skipped_; }
  /// Trials that were not evaluated, as their result was known.
  std::uint64_t skipped_trials() const { return skipped_trials_; }

 protected:
  BatchedSolver() = default;
  BatchedSolver(const BatchedSolver&) = default;
  BatchedSolver& operator=(const BatchedSolver&) = default;
  BatchedSolver(BatchedSolver&&) = default;
  BatchedSolver& operator=(BatchedSolver&&) = default;

  /// The evaluations of the active problems came back: moves the problems,
  /// names those that `accepted_` has to list, and leaves in `active_` and
  /// `trial_` what is to be evaluated next.
  virtual void take(VectorIn<double> loss, BatchIn<double> gradient) = 0;

  /// Opens one run per column of x0: those that are finite are active, and
  /// wait at their start.
  void open(BatchIn<double> x0);
  /// Ends problem i; false, so that it can be returned.
  bool finish(Index i, Status status);

  Index d_ = 0, rounds_ = 0;
  Batch<double> x_, gradient_, trial_;
  Vector<double> loss_;
  std::vector<Status> status_;
  std::vector<Index> iterations_, evaluations_, active_, accepted_;
  std::uint64_t skipped_ = 0, skipped_trials_ = 0;
};

}  // namespace physinv
