/// Which input positions a convolution's taps meet, in pieces that are
/// contiguous in memory.
///
/// Fields inside the convolutional part of a network lie position by position:
/// row = position * channels + channel. The taps of one output position that
/// follow each other along x are then one block of contiguous rows, and a
/// convolution is a matrix product on shifted rows. Nothing is gathered.
#pragma once

#include <vector>

#include "suite/nn/grid.h"

namespace physinv::nn {

/// Taps [tap, tap + taps) of output position p meet the input positions from
/// p + shift on.
struct Segment {
  Index shift = 0, tap = 0, taps = 0;
  bool operator==(const Segment&) const = default;
};

/// Neighbouring output positions with the same segments.
struct WindowRun {
  Index first = 0, count = 0;
  std::vector<Segment> segments;
  Index alike = 0;  ///< the first run with these segments
};

/// Odd numbers of taps per axis, centred, stride 1; tap = row of taps * x + x.
struct Taps {
  Index x = 3, y = 1;
  Index count() const { return x * y; }
};

std::vector<WindowRun> window_runs(Grid grid, Taps taps, Padding padding);

/// The same for the input gradient, whose outputs are the positions of `grid`
/// and whose inputs are those of the convolution's output.
std::vector<WindowRun> flipped_runs(Grid grid, Taps taps, Padding padding);

/// Extent of the output: smaller by taps - 1 without padding.
Grid window_output(Grid grid, Taps taps, Padding padding);

}  // namespace physinv::nn
