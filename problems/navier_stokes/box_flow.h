/// A time step of inviscid flow in the box, and the step back: both components
/// advected with the old velocity, then projected.
#pragma once

#include "problems/fluid/box_projection.h"
#include "problems/fluid/mac_cormack.h"

namespace physinv {

/// What a step starts from and leaves for the step back.
template <class P>
struct FlowStep {
  P *u, *v;            ///< velocity before
  P *u_back, *v_back;  ///< s of both components, zero in their padding
  std::uint8_t *u_held = nullptr, *v_held = nullptr;  ///< may be null
};

template <class P>
class BoxFlow {
 public:
  using T = LaneScalar<P>;
  static constexpr auto kEdge = fluid::Edge::zero;

  BoxFlow(const fluid::BoxProjection<T>& projection, double lambda)
      : projection_(projection),
        u_(projection.faces().u, lambda),
        v_(projection.faces().v, lambda) {}

  const fluid::Plane& cells() const { return projection_.faces().cells; }
  Index decisions() const { return u_.decisions(); }

  /// To u, v, planes other than the step's own.
  void advance(const FlowStep<P>& s, P* u, P* v, P* scratch) const {
    u_.advect(s.u, across_x(s), s.u_back, u, s.u_held, scratch);
    v_.advect(s.v, across_y(s), s.v_back, v, s.v_held, scratch);
    projection_.project(u, v, scratch);
  }

  /// u_bar, v_bar: cotangents of what `advance` made, which are lost; the
  /// step's own go to u_out, v_out.
  void retreat(const FlowStep<P>& s,
               P* u_bar,
               P* v_bar,
               P* u_out,
               P* v_out,
               P* scratch) const {
    projection_.pull(u_bar, v_bar, scratch);
    std::fill_n(u_out, cells().size(), P{});
    std::fill_n(v_out, cells().size(), P{});
    u_.pull(s.u,
            s.u_back,
            across_x(s, u_out, v_out),
            s.u_held,
            u_bar,
            u_out,
            scratch);
    v_.pull(s.v,
            s.v_back,
            across_y(s, u_out, v_out),
            s.v_held,
            v_bar,
            v_out,
            scratch);
  }

  /// u_dot, v_dot to u_out, v_out.
  void push(const FlowStep<P>& s,
            const P* u_dot,
            const P* v_dot,
            P* u_out,
            P* v_out,
            P* scratch) const {
    u_.push(s.u,
            s.u_back,
            across_x(s),
            s.u_held,
            u_dot,
            fluid::face_velocity<kEdge, 0>(u_dot, v_dot, cells().stride),
            u_out,
            scratch);
    v_.push(s.v,
            s.v_back,
            across_y(s),
            s.v_held,
            v_dot,
            fluid::face_velocity<kEdge, 1>(v_dot, u_dot, cells().stride),
            v_out,
            scratch);
    projection_.project(u_out, v_out, scratch);
  }

 private:
  auto across_x(const FlowStep<P>& s, P* u = nullptr, P* v = nullptr) const {
    return fluid::face_velocity<kEdge, 0>(
        static_cast<const P*>(s.u), s.v, cells().stride, u, v);
  }
  auto across_y(const FlowStep<P>& s, P* u = nullptr, P* v = nullptr) const {
    return fluid::face_velocity<kEdge, 1>(
        static_cast<const P*>(s.v), s.u, cells().stride, v, u);
  }

  const fluid::BoxProjection<T>& projection_;
  fluid::MacCormack<kEdge, P> u_, v_;
};

}  // namespace physinv
