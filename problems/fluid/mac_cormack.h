/// MacCormack advection with a limiter, its adjoint and its tangent, all exact
/// for the discrete scheme.
///
///   s = f at (x - lambda v), r = s at (x + lambda v)   (lookup.h)
///   out = s + (f - r) / 2, held between the least and the largest of the four
///   corners of the first lookup
///
/// Where a bound holds, the output is that corner (the first of equal ones)
/// and depends on nothing else; a number on a bound is free. Velocities are
/// asked of a function object: `velocity(at)` gives a Velocity, and
/// `velocity.add(at, x, y)` takes a cotangent.
#pragma once

#include <cstdint>

#include "problems/fluid/lookup.h"

namespace physinv::fluid {

/// The limiter's decision for a point of one sample.
inline constexpr int kFree = 0, kBelow = 1, kAbove = 2;

/// Bytes of decisions and masks of lanes.
template <class P>
struct Decisions {
  using I = typename CellPoint<P>::I;
  typedef std::uint8_t Bytes __attribute__((vector_size(kWidthOf<P>)));

  PHYSINV_LANES static void put(std::uint8_t* to, I below, I above) {
    const I code = (below & kBelow) | (above & kAbove);
    const Bytes bytes = __builtin_convertvector(code, Bytes);
    std::memcpy(to, &bytes, sizeof(bytes));
  }
  PHYSINV_LANES static I get(const std::uint8_t* from) {
    Bytes bytes;
    std::memcpy(&bytes, from, sizeof(bytes));
    return __builtin_convertvector(bytes, I);
  }
};

template <Edge kEdge, class P>
class MacCormack {
 public:
  using T = LaneScalar<P>;
  using I = typename CellPoint<P>::I;
  static constexpr int W = kWidthOf<P>;

  /// Displacements are lambda = dt / dx times the velocity.
  MacCormack(const Plane& plane, double lambda)
      : plane_(plane), lookup_(plane), lambda_(P{} + static_cast<T>(lambda)) {}

  const Plane& plane() const { return plane_; }
  /// Decisions of one plane.
  Index decisions() const { return plane_.rows * plane_.columns * W; }

  /// f with its padding to `out` without; keeps s and, unless null, the
  /// decisions. The padding of s is zero before and written where periodic.
  template <class V>
  void advect(const P* f,
              const V& velocity,
              P* s,
              P* out,
              std::uint8_t* decisions,
              P* scratch) const {
    P* bounds = scratch;
    plane_.for_points([&](Index i, Index j, Index at) {
      const auto spot = lookup_.find_from(i, j, -lambda_, velocity(at));
      P c[4];
      lookup_.read(f, spot, c);
      s[at] = lookup_.interpolate(c, spot).value;
      bounds[0] = least(least(c[0], c[1]), least(c[2], c[3]));
      bounds[1] = most(most(c[0], c[1]), most(c[2], c[3]));
      bounds += 2;
    });
    if constexpr (kEdge == Edge::periodic) wrap(plane_, s);
    bounds = scratch;
    plane_.for_points([&](Index i, Index j, Index at) {
      const auto spot = lookup_.find_from(i, j, lambda_, velocity(at));
      const P r = lookup_.interpolate(s, spot).value;
      const P n = fma_lanes(P{} + T(0.5), f[at] - r, s[at]);
      const I below = n < bounds[0];
      const I above = n > bounds[1];
      out[at] = select(below, bounds[0], select(above, bounds[1], n));
      if (decisions != nullptr) {
        Decisions<P>::put(decisions, below, above);
        decisions += W;
      }
      bounds += 2;
    });
  }

  /// Adds to f_bar and to the velocity's cotangents what g, the cotangent of
  /// `out`, makes of them. Contributions beyond a border stay in the padding;
  /// those of a periodic plane are folded into it.
  template <class V>
  void pull(const P* f,
            const P* s,
            const V& velocity,
            const std::uint8_t* decisions,
            const P* g,
            P* f_bar,
            P* scratch) const {
    P* const s_bar = scratch;
    P* moved = scratch + plane_.size();  // the second lookup's, both ways
    std::fill_n(s_bar, plane_.size(), P{});
    const std::uint8_t* decision = decisions;
    plane_.for_points([&](Index i, Index j, Index at) {
      const P free = select(Decisions<P>::get(decision) == kFree, g[at], P{});
      const P half = T(0.5) * free;
      s_bar[at] += free, f_bar[at] += half;
      const auto spot = lookup_.find_from(i, j, lambda_, velocity(at));
      P c[4];
      lookup_.weigh(-half, spot, c);
      lookup_.add(s_bar, spot, c);
      const auto r = lookup_.interpolate(s, spot);
      const P h = lambda_ * -half;
      moved[0] = h * r.dx, moved[1] = h * r.dy;
      moved += 2, decision += W;
    });
    if constexpr (kEdge == Edge::periodic) fold(plane_, s_bar);
    decision = decisions, moved = scratch + plane_.size();
    plane_.for_points([&](Index i, Index j, Index at) {
      const auto spot = lookup_.find_from(i, j, -lambda_, velocity(at));
      P c[4], c_bar[4];
      lookup_.read(f, spot, c);
      const auto back = lookup_.interpolate(c, spot);
      lookup_.weigh(s_bar[at], spot, c_bar);
      add_held(Decisions<P>::get(decision), g[at], c, c_bar);
      lookup_.add(f_bar, spot, c_bar);
      const P h = lambda_ * -s_bar[at];
      velocity.add(
          at, fma_lanes(h, back.dx, moved[0]), fma_lanes(h, back.dy, moved[1]));
      moved += 2, decision += W;
    });
    if constexpr (kEdge == Edge::periodic) fold(plane_, f_bar);
  }

  /// out_dot for f_dot (with padding) and the velocity's tangent.
  template <class V, class D>
  void push(const P* f,
            const P* s,
            const V& velocity,
            const std::uint8_t* decisions,
            const P* f_dot,
            const D& velocity_dot,
            P* out_dot,
            P* scratch) const {
    P* const s_dot = scratch;
    P* const held_dot = scratch + plane_.size();
    std::fill_n(s_dot, plane_.size(), P{});
    const std::uint8_t* decision = decisions;
    P* bound = held_dot;
    plane_.for_points([&](Index i, Index j, Index at) {
      const auto spot = lookup_.find_from(i, j, -lambda_, velocity(at));
      P c[4], c_dot[4];
      lookup_.read(f, spot, c), lookup_.read(f_dot, spot, c_dot);
      const P moved = shift(lookup_.interpolate(c, spot), velocity_dot(at));
      s_dot[at] =
          fma_lanes(-lambda_, moved, lookup_.interpolate(c_dot, spot).value);
      *bound++ = held_tangent(Decisions<P>::get(decision), c, c_dot);
      decision += W;
    });
    if constexpr (kEdge == Edge::periodic) wrap(plane_, s_dot);
    decision = decisions, bound = held_dot;
    plane_.for_points([&](Index i, Index j, Index at) {
      const auto spot = lookup_.find_from(i, j, lambda_, velocity(at));
      const P moved = shift(lookup_.interpolate(s, spot), velocity_dot(at));
      const P r_dot =
          fma_lanes(lambda_, moved, lookup_.interpolate(s_dot, spot).value);
      const P n_dot = fma_lanes(P{} + T(0.5), f_dot[at] - r_dot, s_dot[at]);
      out_dot[at] =
          select(Decisions<P>::get(decision) == kFree, n_dot, *bound++);
      decision += W;
    });
  }

 private:
  PHYSINV_LANES static P shift(const Interpolated<P>& l, const Velocity<P>& v) {
    return fma_lanes(v.x, l.dx, v.y * l.dy);
  }

  /// Which corner a limited point is; no lane of a free one.
  PHYSINV_LANES static void held_corner(I decision,
                                        const P (&c)[4],
                                        I (&is)[4]) {
    const P low = least(least(c[0], c[1]), least(c[2], c[3]));
    const P high = most(most(c[0], c[1]), most(c[2], c[3]));
    const P bound = select(decision == kBelow, low, high);
    I open = decision != kFree;
    for (int q = 0; q < 4; ++q) {
      is[q] = open & (c[q] == bound);
      open &= ~is[q];
    }
  }
  PHYSINV_LANES static void add_held(I decision,
                                     P g,
                                     const P (&c)[4],
                                     P (&c_bar)[4]) {
    I is[4];
    held_corner(decision, c, is);
    for (int q = 0; q < 4; ++q) c_bar[q] += select(is[q], g, P{});
  }
  PHYSINV_LANES static P held_tangent(I decision,
                                      const P (&c)[4],
                                      const P (&c_dot)[4]) {
    I is[4];
    held_corner(decision, c, is);
    P out{};
    for (int q = 0; q < 4; ++q) out = select(is[q], c_dot[q], out);
    return out;
  }

  /// The lookups of this plane, at a displacement from one of its points.
  struct From : Lookup<kEdge, P> {
    using Lookup<kEdge, P>::Lookup;
    PHYSINV_LANES CellPoint<P> find_from(Index i,
                                         Index j,
                                         P times,
                                         const Velocity<P>& v) const {
      return this->find(fma_lanes(times, v.x, P{} + static_cast<T>(i)),
                        fma_lanes(times, v.y, P{} + static_cast<T>(j)));
    }
  };

  Plane plane_;
  From lookup_;
  P lambda_;
};

}  // namespace physinv::fluid
