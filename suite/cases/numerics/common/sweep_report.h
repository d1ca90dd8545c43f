/// Tables, heat maps and claims from the arrays of stability sweeps
/// (suite/diagnostics/stability_sweep.h).
#pragma once

#include <string>
#include <vector>

#include "suite/cases/numerics/common/sweep_axis.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/evidence/claim.h"
#include "suite/evidence/series.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"
#include "suite/store/record.h"

namespace physinv {

/// The method whose stages are sweeps.
inline constexpr const char* kStability = "stability";

/// A stage of `kStability`, of the first case that finished it, else null.
const StageRecord* find_sweep(const Evidence& e, const std::string& stage);

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
