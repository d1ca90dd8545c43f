/// The blast of air: a Gaussian bell of velocity added to the faces.
///
///   w = exp(-((x - x0)^2 + (y - y0)^2) / (2 width^2)),  u += w vx, v += w vy
#pragma once

#include <vector>

#include "problems/fluid/staggered.h"
#include "suite/core/math.h"

namespace physinv {

template <class P>
struct Blast {
  P x0, vx, vy;
};

template <class T>
class BlastShape {
 public:
  BlastShape(Index cells, double box, double height, double width)
      : faces_(cells, cells),
        cell_(box / double(cells)),
        narrow_(1 / (width * width)) {
    for (Index k = 0; k < 2 * cells; ++k) {
      const double d = 0.5 * double(k + 1) * cell_ - height;
      along_y_.push_back(static_cast<T>(math::exp(-0.5 * d * d * narrow_)));
    }
  }

  /// Adds the blast to planes of faces.
  template <class P>
  void add(const Blast<P>& b, P* u, P* v) const {
    add_bells(
        faces_.u, 0, b, [&](P) { return b.vx; }, u);
    add_bells(
        faces_.v, 1, b, [&](P) { return b.vy; }, v);
  }

  /// Adds its derivative in the direction `dot`.
  template <class P>
  void push(const Blast<P>& b, const Blast<P>& dot, P* u, P* v) const {
    const auto speed = [&](P v0, P v_dot) {
      return [=, this](P d) {
        const P moved = d * static_cast<T>(narrow_) * dot.x0;
        return fma_lanes(moved, v0, v_dot);
      };
    };
    add_bells(faces_.u, 0, b, speed(b.vx, dot.vx), u);
    add_bells(faces_.v, 1, b, speed(b.vy, dot.vy), v);
  }

  /// The transpose of its derivative.
  template <class P>
  Blast<P> pull(const Blast<P>& b, const P* u_bar, const P* v_bar) const {
    const auto sums = [&](const fluid::Plane& g, int half, const P* f) {
      P sum[2] = {};  // of w f, and of w f (x - x0) / width^2
      for (Index i = 0; i < g.rows; ++i) {
        P row{};
        for (Index j = 0; j < g.columns; ++j)
          row = fma_lanes(f[g.at(i, j)], P{} + along_y_[2 * j + half], row);
        const P d = distance(b, i, half), part = bell(d) * row;
        sum[0] = sum[0] + part;
        sum[1] = fma_lanes(d * static_cast<T>(narrow_), part, sum[1]);
      }
      return fluid::Velocity<P>{sum[0], sum[1]};
    };
    const auto x = sums(faces_.u, 0, u_bar), y = sums(faces_.v, 1, v_bar);
    return {fma_lanes(b.vx, x.y, b.vy * y.y), x.x, y.x};
  }

 private:
  /// Adds w speed(x - x0).
  template <class P, class F>
  void add_bells(const fluid::Plane& g,
                 int half,
                 const Blast<P>& b,
                 F&& speed,
                 P* f) const {
    for (Index i = 0; i < g.rows; ++i) {
      const P d = distance(b, i, half), h = speed(d) * bell(d);
      for (Index j = 0; j < g.columns; ++j) {
        P& at = f[g.at(i, j)];
        at = fma_lanes(h, P{} + along_y_[2 * j + half], at);
      }
    }
  }
  /// From x0 to face i, which is at i + 1 (u, half = 0) or i + 1/2 (v) cells.
  template <class P>
  P distance(const Blast<P>& b, Index i, int half) const {
    return static_cast<T>((double(i + 1) - 0.5 * half) * cell_) - b.x0;
  }
  template <class P>
  P bell(P d) const {
    return exp_lanes(d * d * static_cast<T>(-0.5 * narrow_));
  }

  fluid::Staggering<fluid::Edge::zero> faces_;
  double cell_, narrow_;
  std::vector<T> along_y_;  ///< at every half cell, from 1/2
};

}  // namespace physinv
