/// What line-search solvers share that run many independent problems together:
/// every round collects one trial point of each unfinished problem, so that
/// the objective sees them as one batch.
///
///   Bfgs solver(options);
///   solver.start(x0);                       // d x n, one problem per column
///   while (solver.pending()) {
///     objective(solver.active(), solver.points(), loss, gradient);
///     solver.supply(loss, gradient);
///     while (solver.supply_known()) {}
///   }
///
/// or, in one call, drive(solver, objective, x0, observer) of drive.h.
///
/// A finished problem costs nothing more. The bits of a problem do not depend
/// on the others in the batch. A start that is not finite stays as it is with
/// status `nonfinite`, and is never shown to the objective.
///
/// As in SciPy, a trial point that is the last one evaluated, to the bit, is
/// not evaluated again: its search goes on with what is known of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/stop.h"

namespace physinv {

class BatchedSolver {
 public:
  bool pending() const { return !active_.empty(); }
  /// Problems that wait for an evaluation, ascending.
  std::span<const Index> active() const { return active_; }
  /// Where they want it, d x active().size(), in the same order.
  Eigen::Ref<const Batch<double>> points() const {
    return trial_.leftCols(static_cast<Index>(active_.size()));
  }
  /// Losses and gradients at `points()`. A loss or gradient that is not finite
  /// marks a place no search may accept.
  void supply(VectorIn<double> loss, BatchIn<double> gradient);
  /// Problems whose new iterate is their next trial point as well go on with
  /// its loss and gradient. False if there are none; what they accept is
  /// `accepted` then. Without the call they are evaluated once more.
  bool supply_known();
  /// Ends what is still pending, with status `maxiter`.
  void halt() { active_.clear(), known_ = 0; }

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
  /// Those made, as SciPy counts them.
  const std::vector<Index>& evaluations() const { return evaluations_; }

  Index rounds() const { return rounds_; }
  /// Evaluations a fixed batch would have made of finished problems.
  std::uint64_t skipped_evaluations() const { return skipped_; }
  /// Trials that were not evaluated, as their point was known.
  std::uint64_t skipped_trials() const { return skipped_trials_; }

 protected:
  /// An evaluated point.
  struct Point {
    const double* x;
    double loss;
    const double* gradient;
  };

  BatchedSolver() = default;
  BatchedSolver(const BatchedSolver&) = default;
  BatchedSolver& operator=(const BatchedSolver&) = default;
  BatchedSolver(BatchedSolver&&) = default;
  BatchedSolver& operator=(BatchedSolver&&) = default;
  ~BatchedSolver() = default;

  /// Problem i has its start, usable, as its iterate: the first trial point,
  /// or false if it ends.
  virtual bool begin(Index i, double* trial) = 0;
  /// An evaluation came back: the next trial point, or false if it ends.
  virtual bool advance(Index i, const Point& at, double* trial) = 0;

  /// Opens one run per column of x0.
  void open(BatchIn<double> x0);
  /// The point becomes the iterate.
  void accept(Index i, const Point& at);
  bool finish(Index i, Status status);

  Index d_ = 0;
  Batch<double> x_, gradient_, trial_;
  Vector<double> loss_;
  std::vector<Status> status_;
  std::vector<Index> iterations_, evaluations_, active_;

 private:
  template <class F>
  void keep_active(F&& goes_on);
  bool answer(Index i, const Point& at, double* trial);
  bool open_run(Index i, const Point& at, double* trial);

  Index rounds_ = 0, known_ = 0;
  std::uint64_t skipped_ = 0, skipped_trials_ = 0;
  std::vector<char> knows_;              // whose trial point is the new iterate
  Vector<double> last_, last_gradient_;  // of the problem at hand
  std::vector<Index> accepted_;
};

}  // namespace physinv
