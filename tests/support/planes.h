/// Planes of the fluid kernels from matrices a(i, j), and back: the same
/// numbers in every lane.
#pragma once

#include <vector>

#include "problems/fluid/plane.h"
#include "suite/core/batch.h"

namespace physinv::test {

template <class P>
using Packs = std::vector<P>;

template <class P>
Packs<P> blank(const fluid::Plane& g) {
  // Planes of one grid differ in their last row.
  return Packs<P>(static_cast<std::size_t>(g.size() + g.stride), P{});
}

template <class P>
Packs<P> to_plane(const fluid::Plane& g, const Batch<double>& a) {
  Packs<P> f = blank<P>(g);
  g.for_points([&](Index i, Index j, Index at) {
    f[at] = P{} + static_cast<LaneScalar<P>>(a(i, j));
  });
  return f;
}

template <class P>
Batch<double> from_plane(const fluid::Plane& g,
                         const Packs<P>& f,
                         int lane = fluid::kWidthOf<P> - 1) {
  Batch<double> a(g.rows, g.columns);
  g.for_points([&](Index i, Index j, Index at) {
    a(i, j) = static_cast<double>(f[at][lane]);
  });
  return a;
}

template <class P>
Packs<P> scratch(const fluid::Plane& g) {
  return Packs<P>(
      static_cast<std::size_t>(fluid::kScratchPlanes * (g.size() + g.stride)));
}

}  // namespace physinv::test
