/// Cases to workers, longest first.
#pragma once

#include <cstddef>
#include <vector>

namespace physinv {

struct Split {
  std::vector<std::vector<std::size_t>> tasks;  ///< indices, longest first
  double longest = 0;                           ///< seconds of the longest task
  double sum = 0;
  /// Of `tasks` workers, each of which waits for the longest.
  double efficiency() const;
};

/// Each item, the longest first, goes to the task that has least so far
/// (Graham 1969: at most 4/3 of the best). No task is empty: there are at most
/// as many as items.
Split split_longest_first(const std::vector<double>& seconds,
                          std::size_t tasks);

}  // namespace physinv
