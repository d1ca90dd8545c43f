/// What cases will cost, without running anything.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "suite/planning/durations.h"
#include "suite/planning/predict.h"

namespace physinv {

/// In the order of the cases. Times are the published ones of the same stages,
/// in proportion to counted operations and to this machine's `factor`; of other
/// chains those that `trials` has; else not known (NaN).
std::vector<Cost> forecast(const std::vector<Case>& cases,
                           const Durations& published,
                           const Trials& trials,
                           double factor);

/// Puts counted memory into them.
void add_memory(std::vector<Cost>& costs,
                const std::vector<Case>& cases,
                const Durations& published);

/// ", about 12 s" with so many workers; nothing if a case's time is not known,
/// or for work of seconds.
std::string about_text(const std::vector<Case>& cases,
                       int workers,
                       const std::filesystem::path& durations);

/// Wall seconds of so many workers, longest case first; not finite if a case's
/// are not.
double seconds_with(const std::vector<Cost>& costs, int workers);

/// What to split by where not all times are known: such a case counts by its
/// operations, at the median rate of those that are.
std::vector<double> weights_of(const std::vector<Case>& cases,
                               const std::vector<Cost>& costs);

}  // namespace physinv
