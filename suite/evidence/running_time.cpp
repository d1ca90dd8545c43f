#include "suite/evidence/running_time.h"

#include <algorithm>
#include <cmath>

#include "suite/core/rng.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

constexpr std::uint64_t kResamplings = 1000;

/// The quantile's value itself: infinities have no mean.
double ranked(const std::vector<double>& sorted, double q) {
  const double at = q * static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::lround(at))];
}

}  // namespace

RunningTime expected_running_time(const std::vector<double>& cost,
                                  const std::vector<double>& spent,
                                  std::string_view name) {
  RunningTime out{.problems = cost.size()};
  double all = 0;
  for (std::size_t p = 0; p < cost.size(); ++p) {
    out.solved += std::isfinite(cost[p]);
    all += spent[p];
  }
  const auto over = [](double sum, std::size_t solved) {
    return solved == 0 ? kInfinite : sum / static_cast<double>(solved);
  };
  out.expected = out.low = out.high = over(all, out.solved);
  if (out.solved == 0 || std::isnan(all)) return out;
  Stream stream = Rng::root("bootstrap", 0).child(name).stream();
  std::vector<double> again;
  for (std::uint64_t k = 0; k < kResamplings; ++k) {
    double sum = 0;
    std::size_t solved = 0;
    for (std::size_t p = 0; p < cost.size(); ++p) {
      const auto drawn = static_cast<std::size_t>(
          stream.uniform() * static_cast<double>(cost.size()));
      sum += spent[drawn];
      solved += std::isfinite(cost[drawn]);
    }
    again.push_back(over(sum, solved));
  }
  std::sort(again.begin(), again.end());
  out.low = ranked(again, 0.025);
  out.high = ranked(again, 0.975);
  return out;
}

double profile_score(const std::vector<double>& ratios) {
  double area = 0;
  for (const double ratio : ratios)
    area += std::max(0.0, kScoredFactor - ratio) / (kScoredFactor - 1);
  return ratios.empty() ? 0 : area / static_cast<double>(ratios.size());
}

}  // namespace physinv
