/// Planes of numbers, a register of samples at each point: cells or faces of a
/// grid with two layers of padding around them, so that no kernel has a branch
/// at the border. Index i runs along x, j along y and fastest.
#pragma once

#include <algorithm>
#include <cstdint>

#include "suite/core/simd/math.h"

namespace physinv::fluid {

/// Samples side by side: eight, or what a register holds.
template <class T>
inline constexpr int kWidth = kLanes<T> < 8 ? kLanes<T> : 8;
template <class T>
using Samples8 = Pack<T, kWidth<T>>;

template <class P>
inline constexpr int kWidthOf = static_cast<int>(sizeof(P) /
                                                 sizeof(LaneScalar<P>));

struct Plane {
  static constexpr Index kPad = 2;

  Index rows, columns;
  Index stride = columns + 2 * kPad;  ///< larger where planes share offsets

  constexpr Index size() const { return (rows + 2 * kPad) * stride; }
  constexpr Index at(Index i, Index j) const {
    return (i + kPad) * stride + j + kPad;
  }
  /// f(at) at every point, row by row.
  template <class F>
  PHYSINV_LANES void for_points(F&& f) const {
    for (Index i = 0; i < rows; ++i)
      for (Index j = 0, a = at(i, 0); j < columns; ++j) f(i, j, a + j);
  }
};

template <class P>
struct Velocity {
  P x, y;
};

/// Planes of memory that one call of any kernel needs for itself.
inline constexpr Index kScratchPlanes = 3;

/// What is beyond the border: nothing, or the other end.
enum class Edge : std::uint8_t { zero, periodic };

/// Writes the padding of a periodic plane.
template <class P>
void wrap(const Plane& g, P* f) {
  for (Index i = 0; i < g.rows; ++i)
    for (Index k = 0; k < Plane::kPad; ++k) {
      f[g.at(i, -1 - k)] = f[g.at(i, g.columns - 1 - k)];
      f[g.at(i, g.columns + k)] = f[g.at(i, k)];
    }
  const auto copy = [&](Index from, Index to) {
    std::copy_n(
        f + g.at(from, -Plane::kPad), g.stride, f + g.at(to, -Plane::kPad));
  };
  for (Index k = 0; k < Plane::kPad; ++k)
    copy(g.rows - 1 - k, -1 - k), copy(k, g.rows + k);
}

/// Its transpose: adds the padding to the points it copies, and clears it.
template <class P>
void fold(const Plane& g, P* f) {
  const auto add = [&](Index from, Index to) {
    for (Index j = -Plane::kPad; j < g.columns + Plane::kPad; ++j) {
      f[g.at(to, j)] += f[g.at(from, j)];
      f[g.at(from, j)] = P{};
    }
  };
  for (Index k = 0; k < Plane::kPad; ++k)
    add(-1 - k, g.rows - 1 - k), add(g.rows + k, k);
  const auto move = [&](P& from, P& to) { to += from, from = P{}; };
  for (Index i = 0; i < g.rows; ++i)
    for (Index k = 0; k < Plane::kPad; ++k) {
      move(f[g.at(i, -1 - k)], f[g.at(i, g.columns - 1 - k)]);
      move(f[g.at(i, g.columns + k)], f[g.at(i, k)]);
    }
}

}  // namespace physinv::fluid
