#include "suite/nn/window.h"

#include <algorithm>
#include <utility>

#include "suite/core/check.h"

namespace physinv::nn {
namespace {

std::vector<Segment> segments_at(
    Grid grid, Taps taps, Padding padding, Index column, Index row) {
  std::vector<Segment> segments;
  const auto wrap = [](Index i, Index n) { return (i % n + n) % n; };
  for (Index t = 0; t < taps.count(); ++t) {
    Index c = column + t % taps.x - taps.x / 2;
    Index r = row + t / taps.x - taps.y / 2;
    if (padding == Padding::circular) {
      c = wrap(c, grid.columns), r = wrap(r, grid.rows);
    } else if (c < 0 || c >= grid.columns || r < 0 || r >= grid.rows) {
      continue;
    }
    const Index shift = (r - row) * grid.columns + c - column;
    if (!segments.empty()) {
      Segment& last = segments.back();
      if (last.tap + last.taps == t && last.shift + last.taps == shift) {
        ++last.taps;
        continue;
      }
    }
    segments.push_back({shift, t, 1});
  }
  return segments;
}

std::vector<WindowRun> with_alike(std::vector<WindowRun> runs) {
  std::vector<Index> kinds;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto same = std::find_if(kinds.begin(), kinds.end(), [&](Index k) {
      return runs[static_cast<std::size_t>(k)].segments == runs[i].segments;
    });
    runs[i].alike = same != kinds.end() ? *same : static_cast<Index>(i);
    if (same == kinds.end()) kinds.push_back(runs[i].alike);
  }
  return runs;
}

/// Inside a row of `inputs`, output position p's first tap lies at p + first.
std::vector<WindowRun> row_runs(Index outputs,
                                Index inputs,
                                Index taps,
                                Index first) {
  std::vector<WindowRun> runs;
  for (Index p = 0; p < outputs; ++p) {
    const Index begin = std::max<Index>(0, -(p + first));
    const Index end = std::min(taps, inputs - p - first);
    const std::vector<Segment> segments = {{first + begin, begin, end - begin}};
    if (!runs.empty() && runs.back().segments == segments) {
      ++runs.back().count;
    } else {
      runs.push_back({.first = p, .count = 1, .segments = segments});
    }
  }
  return with_alike(std::move(runs));
}

}  // namespace

Grid window_output(Grid grid, Taps taps, Padding padding) {
  if (padding != Padding::none) return grid;
  SUITE_CHECK(grid.flat() && taps.y == 1 && grid.columns >= taps.x,
              "a convolution without padding needs one dimension and at least "
              "as many positions as taps");
  return {grid.columns - taps.x + 1};
}

std::vector<WindowRun> window_runs(Grid grid, Taps taps, Padding padding) {
  SUITE_CHECK(taps.x % 2 == 1 && taps.y % 2 == 1,
              "the number of taps must be odd on each axis");
  SUITE_CHECK(grid.columns > 0 && grid.rows > 0,
              "a grid must have at least one position");
  if (padding == Padding::none)
    return row_runs(
        window_output(grid, taps, padding).columns, grid.columns, taps.x, 0);
  // Between the edges of a row all windows are the same.
  const Index edge = taps.x / 2, last_inside = grid.columns - edge - 1;
  std::vector<WindowRun> runs;
  for (Index p = 0, count = 1; p < grid.positions(); p += count) {
    const Index column = p % grid.columns;
    count = column == edge ? std::max<Index>(1, last_inside - edge + 1) : 1;
    auto segments = segments_at(grid, taps, padding, column, p / grid.columns);
    if (!runs.empty() && runs.back().segments == segments) {
      runs.back().count += count;
    } else {
      runs.push_back(
          {.first = p, .count = count, .segments = std::move(segments)});
    }
  }
  return with_alike(std::move(runs));
}

std::vector<WindowRun> flipped_runs(Grid grid, Taps taps, Padding padding) {
  if (padding != Padding::none) return window_runs(grid, taps, padding);
  return row_runs(grid.columns,
                  window_output(grid, taps, padding).columns,
                  taps.x,
                  1 - taps.x);
}

}  // namespace physinv::nn
