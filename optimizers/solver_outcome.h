/// A finished batched solver as the outcome of a stage.
#pragma once

#include <algorithm>

#include "suite/core/method.h"
#include "suite/core/oracle.h"

namespace physinv {

/// Estimates, statuses and counts of the run of a batched solver (drive.h). The
/// evaluations that finished problems did not need are counted as saved, and so
/// are trials of a known end.
template <class Solver>
Outcome solver_outcome(const Solver& solver, Oracle& oracle) {
  const auto n = static_cast<Index>(solver.status().size());
  Outcome out;
  out.x = solver.x();
  out.status = solver.status();
  out.iterations =
      Eigen::Map<const Vector<Index>>(solver.iterations().data(), n)
          .template cast<double>();
  out.evaluations =
      Eigen::Map<const Vector<Index>>(solver.evaluations().data(), n)
          .template cast<double>();
  const bool converged =
      std::all_of(out.status.begin(), out.status.end(), [](Status s) {
        return s == Status::gtol;
      });
  out.stop = converged ? Stop::converged : Stop::iterations;
  oracle.add(Counter::skipped_forward,
             static_cast<Index>(solver.skipped_evaluations()));
  if constexpr (requires { solver.skipped_trials(); })
    oracle.add(Counter::skipped_trials,
               static_cast<Index>(solver.skipped_trials()));
  return out;
}

}  // namespace physinv
