/// What cases will cost, said soon: short runs as long as there is time, and
/// counted operations for what they did not come to.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "suite/planning/predict.h"

namespace physinv {

struct Forecast {
  std::vector<Cost> costs;  ///< in the order of the cases
  /// Chains that differ in more than n and seed, and of how many short runs
  /// are known. If of none, seconds are not finite.
  std::size_t chains = 0, measured = 0;
};

/// Measures for at most so many seconds, in a process of its own, which may
/// end as it likes: a few iterations of each experiment, then its chains, those
/// with least work first. Speeds are kept in `cache` (Trials::default_file());
/// without one they are forgotten. A chain that was not measured takes as long
/// for an operation as its experiment's median, else its paper's, else that of
/// all.
Forecast forecast(const std::vector<Case>& cases,
                  double seconds,
                  const std::filesystem::path& cache);

/// ", about 12 s" with so many workers; nothing if not known. For somebody who
/// watches it is measured, for a second, unless the work is one of seconds;
/// others are told what is known.
std::string about_text(const std::vector<Case>& cases,
                       int workers,
                       bool watched);

/// Wall seconds of so many workers, longest case first; not finite if a case's
/// are not.
double seconds_with(const std::vector<Cost>& costs, int workers);

}  // namespace physinv
