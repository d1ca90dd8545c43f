/// L-BFGS-B with the semantics of lbfgsb.f 3.0 in SciPy 1.10
/// `minimize(method="L-BFGS-B", jac=True)`, run for many independent problems
/// together (batched_solver.h).
///
/// Byrd, Lu, Nocedal, Zhu: SIAM J. Sci. Comput. 16 (1995); Morales, Nocedal:
/// ACM TOMS 38 (2011). Steps aim at a minimum of the model inside the bounds
/// (steps/box_step.h); their length is that of More and Thuente.
///
/// A search that fails clears the problem's memory, and ends the problem if it
/// is empty. A value that is not finite fails a search; lbfgsb.f would continue
/// with NaN.
#pragma once

#include <utility>
#include <vector>

#include "optimizers/independent_solver.h"
#include "optimizers/steps/box_step.h"
#include "optimizers/steps/limited_memory.h"
#include "optimizers/steps/line_search.h"

namespace physinv {

struct LbfgsbOptions {
  Index memory = 10;    ///< pairs of steps and gradient changes kept
  double pgtol = 1e-5;  ///< done when max|projected gradient| <= pgtol,
  double ftol = 2.2204460492503131e-09;  ///< or f - f' <= ftol max(|f|,|f'|,1)
  Index maxiter = 15000;                 ///< accepted steps
  Index maxfun = 15000;  ///< evaluations, looked at after accepted steps
  int maxls = 20;        ///< evaluations of one line search
  /// Bounds on every problem: one number for each unknown, or one for all, or
  /// none. Infinite where there is no bound.
  std::vector<double> lower = {}, upper = {};
};

/// Ends as `gtol`, `ftol`, `linesearch`, `nonfinite`, or `maxiter` (or maxfun).
/// A search that finds no lower point and returns to its start, which lbfgsb.f
/// takes for a change of the loss within ftol, ends as `linesearch`.
class Lbfgsb final : public IndependentSolver {
 public:
  explicit Lbfgsb(LbfgsbOptions options = {})
      : IndependentSolver(KnownPoint::reuse), options_(std::move(options)) {}

  /// From x0 moved into the bounds; what is not finite is not moved.
  void start(BatchIn<double> x0) override;

 private:
  struct Problem {
    LimitedMemory memory;
    LineSearch line;
    double slope = 0, longest = 0;  // of the current search
  };

  void set_box(Index d);
  bool begin(Index i, double* trial) override;
  bool advance(Index i, const Point& at, double* trial) override;
  bool done(Index i, double loss_before, bool moved);
  void remember(Index i, double slope);
  bool iterate(Index i, double* trial);
  bool start_search(Index i);
  bool restart(Index i, Status otherwise, double* trial);
  bool point(Index i, double* trial) const;
  LineSearchOptions search_options(const Problem& problem) const;

  LbfgsbOptions options_;
  Box box_;
  bool bounded_ = false, boxed_ = false;
  BoxStep aim_;
  std::vector<Problem> problems_;
  Batch<double> target_, direction_;
  Vector<double> step_, change_;
};

}  // namespace physinv
