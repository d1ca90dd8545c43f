/// Whether a stage had its cores to itself, and which of its clocks says how
/// long solving took.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "suite/store/record.h"
#include "suite/store/repetitions.h"

namespace physinv {

/// Wall time above so many times the CPU time: others had the core.
inline constexpr double kCrowdedFactor = 1.25;
/// Seconds that reading clocks, interrupts and page faults take of any stage,
/// however short.
inline constexpr double kClockResolution = 1e-4;

/// By its clocks alone. Threads also wait for each other, so several of them
/// are crowded for sure only where all together had less than a core.
inline bool shared_its_core(Seconds solve) {
  return solve.wall > kCrowdedFactor * solve.cpu &&
         solve.wall - solve.cpu > kClockResolution;
}

/// Its times decide nothing: by its clocks, or as it was found while it ran.
inline bool is_crowded(const StageRecord& stage) {
  return stage.crowded || shared_its_core(stage.clocks.solve);
}

/// Seconds of solving as tables tell them, the median of repetitions: CPU time
/// where no more than one core was at work, as others on the machine add little
/// to it, and where the number of threads changed; else wall time, and nothing
/// of a stage of several threads that was crowded.
inline std::optional<double> seconds_to_tell(const StageRecord& stage) {
  const auto [wall, cpu] = solving_time(stage);
  if (!stage.run.thread_changes.empty()) return cpu;
  if (cpu <= wall + kClockResolution) return std::min(wall, cpu);
  if (stage.crowded) return {};
  return wall;
}

/// How many stages were crowded, in a sentence without its full stop; empty if
/// none were.
std::string crowded_text(const std::vector<CaseRecord>& cases);

}  // namespace physinv
