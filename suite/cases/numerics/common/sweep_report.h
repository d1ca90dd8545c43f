/// Tables, heat maps and claims from the arrays of stability sweeps
/// (suite/diagnostics/stability_sweep.h).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "suite/core/recipe.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/evidence/claim.h"
#include "suite/evidence/series.h"
#include "suite/results/record.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv {

/// A sweep over a grid: point number j * x.size() + i lies at (x[i], y[j]).
struct SweepAxis {
  std::string label;
  std::vector<double> values;
  bool log = false;
};

/// Powers of ten, 10^first, 10^(first + step) .. 10^last.
std::vector<double> decades(double first, double last, double step = 1);

/// One problem for each value of an axis.
std::vector<ProblemRecipe> along(
    const SweepAxis& axis, const std::function<ProblemRecipe(double)>& problem);

/// The stage of the first case that finished it, else null.
const StageRecord* find_sweep(const Results& results,
                              const std::string& experiment,
                              const std::string& method,
                              const std::string& stage);

/// How many cells have which status, by check, and the largest error.
Table sweep_table(std::string id, std::string title, const StageRecord* sweep);

/// Where the forward passes stay finite and accurate; errors of float and of
/// the adjoint, the worst of all examples. No panels without a sweep.
Figure sweep_maps(std::string id,
                  std::string title,
                  const SweepAxis& x,
                  const SweepAxis& y,
                  const StageRecord* sweep);

/// The first of these maps alone.
Panel sweep_map(const SweepAxis& x,
                const SweepAxis& y,
                const StageRecord& sweep,
                std::string title);

/// How many points of a sweep came out so.
Index sweep_count(const StageRecord& sweep,
                  SweepCheck check,
                  SweepStatus status);

/// Claim of the method `stability`: in these stages, wherever the double
/// forward pass is finite, the adjoint agrees with the tangent and with the
/// central differences that decide something.
Claim adjoint_claim(std::string id, const std::vector<std::string>& stages);

}  // namespace physinv
