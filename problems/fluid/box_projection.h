/// Incompressible flow in a closed square with rectangular obstacles: masks of
/// its faces and the projection onto fields without divergence.
///
///   P = Pi C,   Pi = M + M grad A^+ div M   (symmetric, Pi Pi = Pi)
///
/// M: faces between two fluid cells. C: soft obstacles, the product over them
/// of 1 - clip(1 - sqrt(2) d, 0, 1) at distance d (maximum norm, in cells) of
/// the face's centre; 0 on and inside an obstacle, 0.707 half a cell away. A:
/// graph Laplacian of the fluid cells and open faces. It ignores a constant per
/// connected region: one cell of each is grounded, which changes nothing, as
/// what flows out of a region sums to zero.
#pragma once

#include <vector>

#include "problems/fluid/plane.h"
#include "problems/fluid/sparse_cholesky.h"
#include "problems/fluid/staggered.h"
#include "suite/core/options.h"

namespace physinv::fluid {

/// Cells i0 .. i1-1 by j0 .. j1-1.
struct Obstacle {
  Index i0, i1, j0, j1;

  auto fields() const {
    return std::tuple{
        field("i0", i0), field("i1", i1), field("j0", j0), field("j1", j1)};
  }
};

struct BoxMasks {
  BoxMasks(Index n, const std::vector<Obstacle>& obstacles);

  Batch<double> fluid;           ///< 1 or 0 per cell, (i, j)
  Batch<double> open_u, open_v;  ///< M
  Batch<double> kept_u, kept_v;  ///< C
  Batch<int> region;             ///< connected region of a fluid cell, or -1
  int regions = 0;
};

template <class T>
class BoxProjection {
 public:
  explicit BoxProjection(const BoxMasks& masks);

  const Staggering<Edge::zero>& faces() const { return faces_; }

  /// (u, v) <- P (u, v), its transpose, and Pi. Planes of faces; the padding
  /// and whatever else is closed may hold anything and becomes zero.
  template <class P>
  void project(P* u, P* v, P* scratch) const {
    apply(kept_, open_, u, v, scratch);
  }
  template <class P>
  void pull(P* u, P* v, P* scratch) const {
    apply(open_, kept_, u, v, scratch);
  }
  template <class P>
  void orthogonal(P* u, P* v, P* scratch) const {
    apply(open_, open_, u, v, scratch);
  }

 private:
  /// One factor per face; zero where there is none.
  struct Factors {
    std::vector<T> u, v;
  };
  Factors factors(const Batch<double>& u, const Batch<double>& v) const;

  /// after (grad A^+ div + 1) before: the factors of closed faces are zero.
  template <class P>
  void apply(const Factors& before,
             const Factors& after,
             P* u,
             P* v,
             P* scratch) const {
    const Index size = faces_.cells.size(), stride = faces_.cells.stride;
    for (Index a = 0; a < size; ++a) u[a] = u[a] * before.u[a];
    for (Index a = 0; a < size; ++a) v[a] = v[a] * before.v[a];
    P* const p = scratch;
    P* const q = scratch + size;
    const Index count = solver_.size();
    for (Index k = 0; k < count; ++k) {
      const Index a = at_[k];
      q[to_[k]] = (u[a] - u[a - stride]) + (v[a] - v[a - 1]);
    }
    solver_.solve(q);
    std::fill_n(p, size, P{});
    for (Index k = 0; k < count; ++k) p[at_[k]] = q[to_[k]];
    faces_.cells.for_points([&](Index, Index, Index a) {
      u[a] = (u[a] + (p[a + stride] - p[a])) * after.u[a];
      v[a] = (v[a] + (p[a + 1] - p[a])) * after.v[a];
    });
  }

  Staggering<Edge::zero> faces_;
  Factors open_, kept_;
  SparseCholesky<T> solver_;
  std::vector<Index> at_, to_;  ///< of the fluid cells: in a plane, in q
};

extern template class BoxProjection<float>;
extern template class BoxProjection<double>;

}  // namespace physinv::fluid
