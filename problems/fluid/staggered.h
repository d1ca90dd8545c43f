/// Velocities on the faces of a grid of cells, u across x and v across y, in
/// planes of one stride.
///
/// Walled: face (i, j) lies above cell (i, j), u at ((i+1) dx, (j+1/2) dx); the
/// last ones, on the far wall, are zero and belong to no plane. Periodic: face
/// (i, j) lies below cell (i, j).
#pragma once

#include "problems/fluid/plane.h"

namespace physinv::fluid {

template <Edge kEdge>
struct Staggering {
  Plane cells, u, v;

  static constexpr Index kWall = kEdge == Edge::zero ? 1 : 0;

  explicit Staggering(Index rows, Index columns)
      : cells{rows, columns},
        u{rows - kWall, columns, cells.stride},
        v{rows, columns - kWall, cells.stride} {}
};

/// The velocity at the faces across one axis: their own component, and the
/// mean of the four faces of the other one around. With cotangents, `add` puts
/// them where they belong.
template <class P, int kAxis>
struct FaceVelocity {
  const P* own;
  const P* other;
  Index around[4];
  P* own_bar = nullptr;
  P* other_bar = nullptr;

  PHYSINV_LANES Velocity<P> operator()(Index at) const {
    const P* const o = other + at;
    const P mean = LaneScalar<P>(0.25) * ((o[around[0]] + o[around[1]]) +
                                          (o[around[2]] + o[around[3]]));
    return kAxis == 0 ? Velocity<P>{own[at], mean} : Velocity<P>{mean, own[at]};
  }

  PHYSINV_LANES void add(Index at, P x, P y) const {
    own_bar[at] += kAxis == 0 ? x : y;
    const P part = LaneScalar<P>(0.25) * (kAxis == 0 ? y : x);
    for (const Index a : around) other_bar[at + a] += part;
  }
};

/// Faces of the other component around one of this axis.
template <Edge kEdge, int kAxis, class P>
FaceVelocity<P, kAxis> face_velocity(const P* own,
                                     const P* other,
                                     Index stride,
                                     P* own_bar = nullptr,
                                     P* other_bar = nullptr) {
  const Index along = kAxis == 0 ? stride : 1, across = kAxis == 0 ? 1 : stride;
  // Walled faces see forward along their axis and back across it.
  const Index a = kEdge == Edge::zero ? along : -along;
  const Index b = kEdge == Edge::zero ? -across : across;
  return {own, other, {b, 0, a + b, a}, own_bar, other_bar};
}

}  // namespace physinv::fluid
