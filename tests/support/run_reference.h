/// One run of a batched solver against the record of a reference run.
#pragma once

#include <vector>

#include "optimizers/bfgs.h"
#include "optimizers/drive.h"
#include "tests/support/reference.h"

namespace physinv::test {

struct RecordedRun {
  Batch<double> iterates;  ///< the start and every accepted point
  Vector<double> losses;
  Status status = Status::maxiter;
  Index iterations = 0, evaluations = 0;
};

/// Runs the single problem `f(active, x, loss, gradient)` from x0.
template <class Solver, class F>
RecordedRun record(Solver solver, F&& f, const Vector<double>& x0) {
  std::vector<Vector<double>> xs;
  std::vector<double> losses;
  drive(solver, f, x0, [&](const Solver& s) {
    xs.emplace_back(s.x().col(0));
    losses.push_back(s.loss()(0));
  });
  RecordedRun run;
  run.iterates.resize(x0.size(), static_cast<Index>(xs.size()));
  for (std::size_t k = 0; k < xs.size(); ++k)
    run.iterates.col(static_cast<Index>(k)) = xs[k];
  run.losses = Eigen::Map<const Vector<double>>(
      losses.data(), static_cast<Index>(losses.size()));
  run.status = solver.status()[0];
  run.iterations = solver.iterations()[0];
  run.evaluations = solver.evaluations()[0];
  return run;
}

template <class F>
RecordedRun record_bfgs(F&& f,
                        const Vector<double>& x0,
                        double gtol,
                        Index maxiter = 1000) {
  return record(Bfgs({.gtol = gtol, .maxiter = maxiter}), f, x0);
}

int scipy_status(Status status);

/// The first `compared` iterates as one array, the counts of short converged
/// runs, and the outcome. A search that fails at the rounding level (stored
/// status 2) may as well reach the tolerance elsewhere.
void expect_run(const Json& entry,
                const Json& stored,
                const RecordedRun& run,
                Index compared);

}  // namespace physinv::test
