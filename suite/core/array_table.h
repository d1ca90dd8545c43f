/// What stages find in addition to estimates, losses and counts: every array
/// that the suite leaves, by name. Case files, the Python package and
/// docs/data.md have axes and meaning from here; `ArrayKey` (arrays.h) refuses
/// other names. It decides no number, so that its edits make no stage stale.
#pragma once

#include <string_view>

namespace physinv {

struct ArrayInfo {
  std::string_view name;
  /// What the file's axes count. An array of one row has the first one alone.
  std::string_view axes;
  std::string_view unit;  ///< "1" for none; empty: the unknowns' or the clock's
  std::string_view meaning;
  /// Of a name with several meanings: this one if that array is there, too.
  std::string_view beside = {};
};

inline constexpr ArrayInfo kArrays[] = {
    // Solvers that go from a start (optimizers/minimize.h, local_steps.h).
    {"first_step", "samples", "1", "norm of the first step"},
    {"own_loss", "samples", "1", "loss in the precision of the solver"},
    {"path",
     "points,coordinates",
     "",
     "estimates of all examples along the curve"},

    // Training.
    {"parameters", "networks,parameters", "1", "of the network"},
    {"state", "networks,numbers", "1", "running statistics of the network"},
    {"mean_loss", "points", "1", "mean test loss"},
    {"metrics", "points,metrics", "1", "further metrics of the experiment"},
    {"batch_loss", "updates", "1", "loss of the batch before its update"},
    {"training_loss",
     "networks",
     "1",
     "of samples, after the last pass over them"},
    {"late_error", "networks", "1", "mean error of late batches"},
    {"samples_drawn", "networks", "1", "training examples drawn so far"},
    {"weight_change", "networks,tensors", "1", "mean |change| of its weights"},
    {"boundary_weight",
     "networks",
     "1",
     "of the neural adjoint's boundary loss"},
    {"rate", "networks", "1", "learning rate that the search chose"},
    {"searched_rates", "rates", "1", "learning rates that were tried"},
    {"searched_loss", "rates", "1", "losses that they ended with"},
    {"update_cosine",
     "updates",
     "1",
     "of the proxy's gradient and the inverse"},

    // Half-inverses (optimizers/training/half_inverse_rule.h).
    {"kept", "updates", "1", "singular values that were inverted"},
    {"smallest", "updates", "1", "the smallest of them over the largest"},
    {"path", "updates", "1", "hig::Path, the algorithm that inverted them"},
    {"unproven", "networks", "1", "updates whose accuracy was not shown"},

    // Hessian-free training (optimizers/training/hessian_free_rule.h).
    {"cg_iterations", "updates", "1", "of conjugate gradients"},
    {"damping", "updates", "1", "lambda"},
    {"rho", "updates", "1", "reduction over the one that was predicted"},
    {"chosen", "updates", "1", "iterate of conjugate gradients that was taken"},
    {"alpha", "updates", "1", "length of the step by line search"},
    {"objective", "updates", "1", "of the batch before its update"},
    {"objective_after", "updates", "1", "of the batch after its update"},

    // Alignment of gradients (suite/diagnostics/alignment.h).
    {"sum", "runs,repetitions", "1", "share aligned with the sum"},
    {"vote", "runs,repetitions", "1", "share aligned with the majority"},
    {"clipped", "runs,repetitions", "1", "share with clipped gradients"},
    {"noise_free", "runs,repetitions", "1", "share without noise"},

    // Growth with the end time (suite/diagnostics/growth.h).
    {"time", "horizons", "", "end times"},
    {"gradient", "horizons,samples", "1", "norm of the loss gradient", "time"},
    {"gradient_single", "horizons,samples", "1", "the same in float"},
    {"gradient_error", "horizons,samples", "1", "its relative error in float"},
    {"perturbation", "horizons,samples", "1", "growth of a perturbation"},
    {"perturbation_single", "horizons,samples", "1", "the same in float"},
    {"rounding",
     "horizons,samples",
     "1",
     "relative error of the state in float"},

    // Sweeps (suite/diagnostics/stability_sweep.h, work_precision.h): -1 where
    // an error is not a number.
    {"point", "cells,unknowns", "", "where derivatives were checked"},
    {"status", "cells,checks", "1", "what each check found", "point"},
    {"error", "cells,checks", "1", "of each check, relative", "point"},
    {"error", "samples", "1", "relative to the exact values"},

    // Half-inverses under stress (suite/diagnostics/half_inverse_stress.h).
    {"cell", "cells,axes", "1", "its position on each axis"},
    {"status", "cells", "1", "StressStatus", "cell"},
    {"loss", "cells,ends", "1", "before the updates and after them", "cell"},
    {"size", "cells,parts", "1", "of updates by what is kept and cut", "cell"},
    {"norm", "cells", "1", "largest norm of an update", "cell"},
    {"kept", "cells", "1", "singular values that were inverted", "cell"},
    {"path",
     "cells",
     "1",
     "hig::Path, the algorithm that inverted them",
     "cell"},
    {"rows", "cells", "1", "of the matrix that was inverted", "cell"},

    // Transport of flows (suite/cases/numerics/transport).
    {"step", "points", "1", "time steps so far"},
    {"energy", "points,samples", "1", "|E - E(0)| / E(0) in double"},
    {"energy_single", "points,samples", "1", "the same in float"},
    {"unscaled", "points,samples", "1", "energy left if it were not restored"},
    {"divergence", "points,samples", "1", "net flow out of a cell, relative"},
    {"cells", "grids", "1", "a side"},
    {"constant", "grids", "1", "error of constant velocity"},
    {"shear", "grids", "1", "error of a shear flow"},
    {"free", "grids", "1", "error of one step without limiter"},

    // The chapter on scaling (suite/cases/physgrad/scaling): a column for each
    // setting, of which the first row says what it is.
    {"order", "settings,numbers", "1", "|dy|, inverse step and goal missed by"},
    {"linear", "settings,numbers", "1", "alpha, steps of gradient and inverse"},
    {"roots", "settings,numbers", "1", "observation, guess, inverse"},
    {"inner", "settings,methods", "1", "change of y made over the one asked"},
    {"average", "settings,numbers", "1", "share of y, slope, mean of slopes"},
    {"local", "settings,numbers", "1", "move, error of the inverse"},
    {"singular", "settings,numbers", "1", "curvature, finite quotient, step"},
    {"small", "settings,numbers", "1", "alpha, shares of gradient and inverse"},
    {"reversed", "settings,numbers", "1", "time step, distance from the start"},
    {"batch", "runs,numbers", "1", "trajectories and steps"},
    {"ends", "coordinates", "", "where the trajectories end"},

    // Of a stage read from results.json (suite/results/loss_summary.h).
    {"losses", "runs,numbers", "1", "mean, median, largest"}};

/// Null for arrays of others.
constexpr const ArrayInfo* find_array(std::string_view name) {
  for (const ArrayInfo& a : kArrays)
    if (a.name == name) return &a;
  return nullptr;
}

/// The line that fits the other arrays, and a list or a matrix.
template <class StandsBeside>
constexpr const ArrayInfo* find_array(std::string_view name,
                                      bool list,
                                      StandsBeside stands_beside) {
  const ArrayInfo* found = nullptr;
  for (const ArrayInfo& a : kArrays) {
    if (a.name != name || (!a.beside.empty() && !stands_beside(a.beside)))
      continue;
    if (!list && a.axes.find(',') == a.axes.npos) continue;
    const bool nearer =
        found == nullptr || (found->beside.empty() && !a.beside.empty());
    const bool lists = list && found != nullptr && found->beside == a.beside &&
                       a.axes.find(',') == a.axes.npos;
    if (nearer || lists) found = &a;
  }
  return found;
}

}  // namespace physinv
