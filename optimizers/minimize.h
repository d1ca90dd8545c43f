/// Any batched solver (batched_solver.h) on the problems of a case, as a stage
/// of a method. With a solver of your own:
///
///   make_stage({.name = "solve",
///               .needs = Needs::forward | Needs::vjp,
///               .options = describe(options),
///               .iterations = 100,
///               .networks = Networks::none,
///               .operations = ...},
///              [options](StageRun& run) {
///                MySolver solver(options);
///                return minimize(solver, run, run.oracle.start());
///              });
#pragma once

#include "optimizers/batched_solver.h"
#include "optimizers/stage.h"
#include "suite/core/oracle.h"

namespace physinv {

/// Minimizes the true losses from x0, one problem per column. The oracle counts
/// the evaluations, the probe keeps clock and curve. Array left: `first_step`
/// (1 x examples), length of the first accepted step, 0 if there is none.
/// In f32 losses and gradients are evaluated in float and the losses rounded to
/// it; array `own_loss` has those of the estimates.
Outcome minimize(BatchedSolver& solver,
                 StageRun& run,
                 const Batch<double>& x0,
                 Precision precision = Precision::f64);

/// Estimates, statuses and counts of a run that has ended, for code that drives
/// a solver on another objective. The evaluations that finished problems did
/// not need are counted as saved, and so are trials of a known end.
Outcome outcome_of(const BatchedSolver& solver, Oracle& oracle);

}  // namespace physinv
