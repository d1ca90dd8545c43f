#include "suite/planning/split.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <tuple>

namespace physinv {

double Split::efficiency() const {
  return longest > 0 ? sum / (longest * static_cast<double>(tasks.size())) : 1;
}

Split split_longest_first(const std::vector<double>& seconds,
                          std::size_t tasks) {
  Split split;
  split.tasks.resize(std::max<std::size_t>(1, std::min(tasks, seconds.size())));
  std::vector<std::size_t> order(seconds.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
    return seconds[a] > seconds[b];
  });
  // The number of items comes second, so that items without a cost spread too.
  using Load = std::tuple<double, std::size_t, std::size_t>;
  std::priority_queue<Load, std::vector<Load>, std::greater<>> least;
  for (std::size_t t = 0; t < split.tasks.size(); ++t) least.push({0, 0, t});
  for (const std::size_t item : order) {
    const auto [load, items, task] = least.top();
    least.pop();
    split.tasks[task].push_back(item);
    split.sum += seconds[item];
    split.longest = std::max(split.longest, load + seconds[item]);
    least.push({load + seconds[item], items + 1, task});
  }
  return split;
}

}  // namespace physinv
