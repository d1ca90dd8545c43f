/// BFGS with the semantics of SciPy 1.10 `minimize(method="BFGS", jac=True,
/// tol=gtol)`, run for many independent problems together.
///
/// How it is used: batched_solver.h. A search halves its interval at a loss of
/// +inf, as SciPy's does. Where SciPy would continue with NaN, it fails (see
/// line_search.h), or halves as well if the option says so: results are finite
/// if the start and its loss are.
#pragma once

#include <vector>

#include "optimizers/independent_solver.h"
#include "optimizers/steps/first_trial.h"
#include "optimizers/steps/line_search.h"

namespace physinv {

struct BfgsOptions {
  double gtol = 1e-5;    ///< done when max|gradient| <= gtol
  Index maxiter = 1000;  ///< accepted steps
  /// Beyond SciPy: done when the last kStallSteps steps together lowered the
  /// loss by less than this share of it. 0: never.
  double stall = 0;
  FirstTrial first_trial = FirstTrial::scipy;
  LineSearchOptions search = {};
};

inline constexpr Index kStallSteps = 3;

/// Ends as `gtol`, `ftol` (stalled), `linesearch`, `nonfinite`, or `maxiter`.
class Bfgs final : public IndependentSolver {
 public:
  explicit Bfgs(const BfgsOptions& options = {})
      : IndependentSolver(KnownPoint::reuse), options_(options) {}

  void start(BatchIn<double> x0) override;

 private:
  bool begin(Index i, double* trial) override;
  bool advance(Index i, const Point& at, double* trial) override;
  bool iterate(Index i, double* trial);
  double first_step(Index i, double slope) const;
  bool search(Index i, LineSearch::Next next, double* trial);
  bool stalls(Index i);

  double* hessian(Index i) { return hessian_.data() + i * d_ * d_; }

  BfgsOptions options_;
  Batch<double> direction_;
  Batch<double> hessian_;  // inverse Hessians, d*d x n
  Batch<double> earlier_;  // losses kStallSteps ago and since, a ring
  Vector<double> previous_loss_, step_, change_, scratch_;
  std::vector<LineSearch> searches_;
};

}  // namespace physinv
