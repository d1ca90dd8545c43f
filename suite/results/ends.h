/// Which of two ends is better: the one order of ends, statuses and verdicts,
/// by which `compare` and `gate` judge.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/stop.h"
#include "suite/results/report_model.h"

namespace physinv {

/// From one to another. `other`: they differ, and neither is better.
enum class Direction { same, better, worse, other };
std::string_view to_string(Direction direction);

/// converged, iterations, diverged; last those without a result, failed and
/// skipped, neither of which is better.
Direction direction(Stop from, Stop to);

/// Examples of a stage by status.
using StatusCounts = std::array<Index, kStatuses.size()>;
StatusCounts count(const std::vector<Status>& statuses);
/// "gtol 3, maxiter 1"
std::string status_text(const StatusCounts& counts,
                        std::string_view between = ", ",
                        char mark = ' ');

/// The more examples are `nonfinite`, the worse; with as many of them, the
/// fewer fulfil a tolerance, `gtol` or `ftol`. Of these two neither is better,
/// nor of maxiter and linesearch.
Direction direction(const StatusCounts& from, const StatusCounts& to);

/// reproduced, partly judged, not judged, then what fails: explained by its
/// cause (whatever that is), not reproduced. A claim that failed and is judged
/// no more is not better, and numbers that no condition decides are neither.
Direction direction(Verdict from, Verdict to);

}  // namespace physinv
