/// BFGS with the semantics of SciPy 1.10 `minimize(method="BFGS", jac=True,
/// tol=gtol)`, run for many independent problems together.
///
/// Every round collects one trial point of each unfinished problem, so that
/// the objective sees them as one batch:
///
///   Bfgs solver(options);
///   solver.start(x0);                       // d x n, one problem per column
///   while (solver.pending()) {
///     objective(solver.active(), solver.points(), loss, gradient);
///     solver.supply(loss, gradient);
///   }
///
/// or, in one call, drive(solver, objective, x0, observer) of drive.h.
///
/// A finished problem costs nothing more. The bits of a problem do not depend
/// on the others in the batch. Nothing allocates between `start` and the end,
/// nor in `start` if the size is that of an earlier run. Where SciPy would
/// walk on with NaN, a search fails (see line_search.h): results are finite if
/// the loss at the start is.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "optimizers/steps/line_search.h"
#include "suite/core/batch.h"
#include "suite/core/stop.h"

namespace physinv {

struct BfgsOptions {
  double gtol = 1e-5;    ///< done when max|gradient| <= gtol
  Index maxiter = 1000;  ///< accepted steps
  /// Beyond SciPy: done when the last kStallSteps steps together lowered the
  /// loss by less than this share of it. 0: never.
  double stall = 0;
  LineSearchOptions search = {};
};

inline constexpr Index kStallSteps = 3;

class Bfgs {
 public:
  explicit Bfgs(const BfgsOptions& options = {}) : options_(options) {}

  /// Begins one run per column of x0 (d x n).
  void start(BatchIn<double> x0);

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
  /// Ends what is still pending, with status `maxiter`.
  void halt() { active_.clear(); }

  /// Problems that accepted a new iterate in the last round; in the first
  /// round those whose start is usable (iteration 0).
  std::span<const Index> accepted() const { return accepted_; }

  // Per problem; valid at any time after the first round.
  const Batch<double>& x() const { return x_; }  ///< last accepted iterate
  const Vector<double>& loss() const { return loss_; }
  const Batch<double>& gradient() const { return gradient_; }
  /// `gtol` (stalled problems, too), `linesearch`, `nonfinite`, or `maxiter`,
  /// also while running.
  const std::vector<Status>& status() const { return status_; }
  const std::vector<Index>& iterations() const { return iterations_; }
  const std::vector<Index>& evaluations() const { return evaluations_; }

  Index rounds() const { return rounds_; }
  /// Evaluations a fixed batch would have made of finished problems.
  std::uint64_t skipped_evaluations() const { return skipped_; }

 private:
  bool begin(Index i, double loss, const double* gradient, double* trial);
  bool advance(
      Index i, Index at, double loss, const double* gradient, double* trial);
  void move(Index i, const double* to, double loss, const double* gradient);
  bool iterate(Index i, double* trial);
  bool search(Index i, LineSearch::Next next, double* trial);
  bool stalls(Index i);
  bool finish(Index i, Status status);

  double* hessian(Index i) { return hessian_.data() + i * d_ * d_; }

  BfgsOptions options_;
  Index d_ = 0, rounds_ = 0;
  std::uint64_t skipped_ = 0;
  Batch<double> x_, gradient_, direction_, trial_;
  Batch<double> hessian_;  // inverse Hessians, d*d x n
  Batch<double> earlier_;  // losses kStallSteps ago and since, a ring
  Vector<double> loss_, previous_loss_, step_, change_, scratch_;
  std::vector<LineSearch> searches_;
  std::vector<Status> status_;
  std::vector<Index> iterations_, evaluations_, active_, accepted_;
};

}  // namespace physinv
