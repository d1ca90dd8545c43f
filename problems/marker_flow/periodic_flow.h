/// A time step of inviscid flow on a periodic square that carries a marker, and
/// the step back. Both components are advected with the old velocity and
/// projected, both scaled to the energy that was there before; the marker goes
/// with the new velocity.
#pragma once

#include "problems/fluid/mac_cormack.h"
#include "problems/marker_flow/periodic_projection.h"

namespace physinv {

/// The velocity at the cells' centres, of faces below them.
template <class P>
struct CentreVelocity {
  const P *u, *v;
  Index stride;
  P *u_bar = nullptr, *v_bar = nullptr;

  PHYSINV_LANES fluid::Velocity<P> operator()(Index at) const {
    constexpr auto kHalf = LaneScalar<P>(0.5);
    return {kHalf * (u[at] + u[at + stride]), kHalf * (v[at] + v[at + 1])};
  }
  PHYSINV_LANES void add(Index at, P x, P y) const {
    const P a = LaneScalar<P>(0.5) * x, b = LaneScalar<P>(0.5) * y;
    u_bar[at] += a, u_bar[at + stride] += a;
    v_bar[at] += b, v_bar[at + 1] += b;
  }
};

/// What a step starts from and leaves for the step back.
template <class P>
struct MarkerStep {
  P *u, *v, *m;                 ///< before, with their padding
  P *u_back, *v_back, *m_back;  ///< s of the three
  P* energy;                    ///< of the step's start and of its projection
  std::uint8_t *u_held = nullptr, *v_held = nullptr, *m_held = nullptr;
};

/// The three fields of a state, or their cotangents.
template <class P>
struct MarkerState {
  P *u, *v, *m;
};

template <class P>
class PeriodicFlow {
 public:
  using T = LaneScalar<P>;
  static constexpr auto kEdge = fluid::Edge::periodic;

  PeriodicFlow(Index cells, double lambda)
      : projection_(cells), advection_(projection_.faces().cells, lambda) {}

  const fluid::Plane& plane() const { return projection_.faces().cells; }
  Index decisions() const { return advection_.decisions(); }

  /// Centred velocities, with their padding, to faces without divergence.
  void to_faces(const P* x, const P* y, P* u, P* v, P* scratch) const {
    const Index stride = plane().stride;
    plane().for_points([&](Index, Index, Index at) {
      u[at] = T(0.5) * (x[at - stride] + x[at]);
      v[at] = T(0.5) * (y[at - 1] + y[at]);
    });
    project(u, v, scratch);
  }
  /// Its transpose; u, v are lost, and have their padding afterwards.
  void from_faces(P* u, P* v, P* x, P* y, P* scratch) const {
    project(u, v, scratch);
    const Index stride = plane().stride;
    plane().for_points([&](Index, Index, Index at) {
      x[at] = T(0.5) * (u[at] + u[at + stride]);
      y[at] = T(0.5) * (v[at] + v[at + 1]);
    });
  }

  /// To planes other than the step's own.
  void advance(const MarkerStep<P>& s,
               const MarkerState<P>& to,
               P* scratch) const {
    const auto carry = [&](auto... all) { advection_.advect(all..., scratch); };
    carry(s.u, across_x(s), s.u_back, to.u, s.u_held);
    carry(s.v, across_y(s), s.v_back, to.v, s.v_held);
    projection_.project(to.u, to.v, scratch);
    s.energy[0] = energy(s.u, s.v), s.energy[1] = energy(to.u, to.v);
    const P scale = Scaling(s.energy).factor;
    plane().for_points(
        [&](Index, Index, Index at) { to.u[at] *= scale, to.v[at] *= scale; });
    wrap(plane(), to.u), wrap(plane(), to.v);
    carry(s.m, centres(to), s.m_back, to.m, s.m_held);
    wrap(plane(), to.m);
  }

  /// bar: cotangents of what `advance` made, `now`; those of u and v are lost
  /// and have no padding. The step's own go to `out`.
  void retreat(const MarkerStep<P>& s,
               const MarkerState<P>& now,
               const MarkerState<P>& bar,
               const MarkerState<P>& out,
               P* scratch) const {
    for (P* const f : {out.u, out.v, out.m})
      std::fill_n(f, plane().size(), P{});
    const auto pull = [&](auto... all) { advection_.pull(all..., scratch); };
    pull(s.m, s.m_back, centres(now, bar), s.m_held, bar.m, out.m);
    fold(plane(), bar.u), fold(plane(), bar.v);

    const Scaling scaling(s.energy);
    const P moved = dot(bar, now) / scaling.factor / cells();
    const P to_end = select(scaling.acts, moved / scaling.after, P{});
    const P to_start =
        select(scaling.acts, moved * scaling.factor / scaling.before, P{});
    plane().for_points([&](Index, Index, Index at) {
      bar.u[at] = fma_lanes(-to_end, now.u[at], scaling.factor * bar.u[at]);
      bar.v[at] = fma_lanes(-to_end, now.v[at], scaling.factor * bar.v[at]);
    });
    projection_.project(bar.u, bar.v, scratch);

    pull(s.u, s.u_back, across_x(s, out.u, out.v), s.u_held, bar.u, out.u);
    pull(s.v, s.v_back, across_y(s, out.u, out.v), s.v_held, bar.v, out.v);
    fold(plane(), out.u), fold(plane(), out.v);
    plane().for_points([&](Index, Index, Index at) {
      out.u[at] = fma_lanes(to_start, s.u[at], out.u[at]);
      out.v[at] = fma_lanes(to_start, s.v[at], out.v[at]);
    });
  }

  /// mean(u^2) + mean(v^2)
  P energy(const P* u, const P* v) const {
    return sum([=](P row, Index at) {
             return fma_lanes(v[at], v[at], fma_lanes(u[at], u[at], row));
           }) /
           cells();
  }

  /// Of f(sum, at) over a row, added row by row.
  template <class F>
  P sum(F&& f) const {
    P all{};
    for (Index i = 0; i < plane().rows; ++i) {
      P row{};
      for (Index j = 0; j < plane().columns; ++j)
        row = f(row, plane().at(i, j));
      all = all + row;
    }
    return all;
  }

 private:
  /// sqrt(before / after), or 1 where either is nothing.
  struct Scaling {
    typename fluid::CellPoint<P>::I acts;
    P before, after, factor;

    explicit Scaling(const P* energy)
        : acts((energy[0] > P{}) & (energy[1] > P{})),
          before(select(acts, energy[0], one())),
          after(select(acts, energy[1], one())),
          factor(sqrt_lanes(before / after)) {}
    static P one() { return T(1) - P{}; }
  };

  P cells() const {
    return static_cast<T>(plane().rows * plane().columns) - P{};
  }
  P dot(const MarkerState<P>& a, const MarkerState<P>& b) const {
    return sum([&](P row, Index at) {
      return fma_lanes(a.v[at], b.v[at], fma_lanes(a.u[at], b.u[at], row));
    });
  }
  void project(P* u, P* v, P* scratch) const {
    projection_.project(u, v, scratch);
    wrap(plane(), u), wrap(plane(), v);
  }
  auto across_x(const MarkerStep<P>& s, P* u = nullptr, P* v = nullptr) const {
    return fluid::face_velocity<kEdge, 0>(
        static_cast<const P*>(s.u), s.v, plane().stride, u, v);
  }
  auto across_y(const MarkerStep<P>& s, P* u = nullptr, P* v = nullptr) const {
    return fluid::face_velocity<kEdge, 1>(
        static_cast<const P*>(s.v), s.u, plane().stride, v, u);
  }
  CentreVelocity<P> centres(const MarkerState<P>& s,
                            const MarkerState<P>& bar = {}) const {
    return {s.u, s.v, plane().stride, bar.u, bar.v};
  }

  fluid::PeriodicProjection<T> projection_;
  fluid::MacCormack<kEdge, P> advection_;
};

}  // namespace physinv
