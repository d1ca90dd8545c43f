/// The expected running time (ERT) of COCO (Hansen et al., Optim. Methods
/// Softw. 36, 2021): what a method spends until it reaches a target if it is
/// started again, on another problem, wherever it fails.
#pragma once

#include <string_view>
#include <vector>

namespace physinv {

struct RunningTime {
  /// Infinite if nothing was solved, else NaN if something spent is unknown.
  double expected = 0;
  double low = 0, high = 0;  ///< 2.5 % and 97.5 % of the resampled
  std::size_t solved = 0, problems = 0;
};

/// `cost` until the target, infinite where it is not reached; `spent` is the
/// same and, where it is not reached, all that was spent, NaN if not known:
/// a run without a cost would make a method that gives up look cheap. The
/// interval is of 1,000 resamplings of the problems (percentile bootstrap,
/// Efron 1979), drawn from the stream of this name: same costs, same interval.
RunningTime expected_running_time(const std::vector<double>& cost,
                                  const std::vector<double>& spent,
                                  std::string_view name);

/// A method's score: the area below its performance profile from a factor of 1
/// to 4, over that width (Dahl et al. 2023, AlgoPerf). 1: fastest everywhere.
double profile_score(const std::vector<double>& ratios);
inline constexpr double kScoredFactor = 4;

}  // namespace physinv
