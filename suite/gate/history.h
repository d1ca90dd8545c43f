/// The contents of a baseline, commit by commit: losses, instructions and
/// seconds, linked from each commit to the next over what both have.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// A baseline of any version, as far as a history needs it.
struct PastBaseline {
  std::string commit, date, subject;  ///< of the commit that wrote it
  std::string machine, counter;
  struct Stage {
    std::string results;         ///< hash
    std::string stop;            ///< empty in old versions
    std::optional<double> loss;  ///< median of those that are finite
    std::int64_t nonfinite = 0;  ///< losses that are not
    double fastest_ms = 0;       ///< 0: not known
    bool failed() const;         ///< or skipped, or diverged
  };
  std::map<std::string, Stage> stages;
  std::map<std::string, std::uint64_t> instructions;  ///< of cases
};

/// std::runtime_error if it is not a baseline.
PastBaseline past_baseline(std::string_view text);

/// Figures over the commits, oldest first, and a table of them; nothing of
/// fewer than two. Losses link over stages of one name with as many losses that
/// are finite, both raised to kEqualLoss; instructions over cases of one
/// counter; seconds where the machine is the same and both stages reached their
/// ends. What failed or diverged links nothing and is counted.
std::vector<Section> history_of(const std::vector<PastBaseline>& past);

}  // namespace physinv
