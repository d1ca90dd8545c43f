/// What one side of a comparison says of one stage, or of a group of them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "suite/results/ends.h"
#include "suite/results/solved_loss.h"
#include "suite/store/record.h"

namespace physinv {

/// Median and quartiles of so many numbers.
struct Quartiles {
  double low = 0, median = 0, high = 0;
  std::size_t count = 0;
  /// From one quartile to the other; of one number nothing is known.
  std::optional<double> range() const {
    return count > 1 ? std::optional(high - low) : std::nullopt;
  }
};
/// Of a list that is not empty; infinities are numbers.
Quartiles quartiles_of(const std::vector<double>& values);

/// Seconds of solving a stage, over its repetitions. A clock without a number
/// makes them infinite.
struct Times {
  Quartiles wall, cpu;
  int threads = 1;  ///< 0: not known
  bool crowded = false;

  /// Where one thread ran, or, if their number is not known, no more than one
  /// core was at work: others on the machine add little to CPU time.
  bool of_one_core() const;
};

struct Reading {
  std::size_t stages = 0;
  std::size_t same_bits = 0;  ///< as on the first side
  std::map<Stop, Index> ends;
  StatusCounts statuses{};
  Index nonfinite = 0;  ///< losses
  Index solved = 0;     ///< losses at most Thresholds::solved
  /// Losses that are known one by one; 0 where only their median is stored.
  Index examples = 0;
  Index position = 0;   ///< of a stage in its chain
  std::string message;  ///< of a stage: why it failed or was skipped
  /// Over the examples of a stage, over the stages of a group; infinite where
  /// it is not finite.
  Quartiles loss;
  /// Of a stage that converged or ran its iterations; of a group its stages'
  /// seconds.
  std::optional<Times> times;
  Index iterations = 0;
  Counts counts;

  double simulations() const;
  double passes() const;  ///< of networks
};

inline double percent_of(Index part, Index whole) {
  return 100 * static_cast<double>(part) / static_cast<double>(whole);
}

/// From where a difference counts.
struct Thresholds {
  double factor = 1.5;  ///< a ratio of times within it is not a change
  double solved =
      kSolvedByDefault;  ///< an example with a loss of at most this is solved
};

/// `first` is the same stage on the first side, if that has it.
Reading reading_of(const StageRecord& stage,
                   const StageRecord* first,
                   const Thresholds& thresholds);
/// Of the readings of its stages; one at least.
Reading reading_of(const std::vector<const Reading*>& stages);

/// How the end of a stage changed: that of the stage before those of its
/// examples, and one worse thing outweighs a better one.
Direction end_direction(const Reading& from, const Reading& to);
/// "converged -> failed: out of memory"; empty if the ends are the same.
std::string end_text(const Reading& from, const Reading& to);

/// b over a, both raised to kEqualLoss; 1 if neither is finite.
double loss_ratio(const Reading& a, const Reading& b);

/// Costs, time and work, compare between stages that both converged or ran
/// their iterations, with as many losses that are finite: a stage that fails,
/// is skipped or diverges spends less and gains nothing.
bool costs_compare(const Reading& a, const Reading& b);

/// Of two stages whose costs compare. CPU times are compared where both are of
/// one core; else wall times, unless one of the two was crowded.
struct TimeRatio {
  std::optional<double> value;  ///< b over a
  std::string why;              ///< there is none: "failed", "crowded", ...
  bool compares = false;        ///< `a` and `b` hold what is compared, seconds
  Quartiles a, b;
  /// One of the two should have a time, and its clock has no number.
  bool a_unknown = false, b_unknown = false;
};
TimeRatio time_ratio(const Reading& a, const Reading& b);

/// Seconds below this are short: that they differ counts for nothing.
inline constexpr double kShortTime = 1e-2;
/// b over a, both raised to kShortTime; empty if they do not compare.
std::optional<double> raised_ratio(const TimeRatio& times);
/// By more than this factor, both raised to kShortTime: all but a quarter of
/// b's repetitions against all but a quarter of a's.
bool is_slower(const TimeRatio& times, double factor);

}  // namespace physinv
