#include "problems/fluid/box_projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "suite/core/check.h"

namespace physinv::fluid {
namespace {

/// C of one obstacle at a place, in cells.
double kept(const Obstacle& o, double x, double y) {
  const auto beyond = [](double at, Index from, Index to) {
    return std::abs(at - 0.5 * double(from + to)) - 0.5 * double(to - from);
  };
  const double d = std::max(beyond(x, o.i0, o.i1), beyond(y, o.j0, o.j1));
  return 1 - std::clamp(1 - std::numbers::sqrt2 * d, 0.0, 1.0);
}

/// All cells connected with (i, j) through open faces.
void flood(BoxMasks& m, Index i, Index j, int region) {
  const Index n = m.fluid.rows();
  std::vector<std::pair<Index, Index>> open{{i, j}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    if (a < 0 || b < 0 || a >= n || b >= n) continue;
    if (m.fluid(a, b) == 0 || m.region(a, b) >= 0) continue;
    m.region(a, b) = region;
    open.insert(open.end(), {{a + 1, b}, {a - 1, b}, {a, b + 1}, {a, b - 1}});
  }
}

/// The Laplacian of the fluid cells, numbered row by row, one of every region
/// grounded.
Eigen::SparseMatrix<double> laplacian(const BoxMasks& m) {
  const Index n = m.fluid.rows();
  Batch<Index> number = Batch<Index>::Constant(n, n, -1);
  Index count = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (m.fluid(i, j) != 0) number(i, j) = count++;
  std::vector<Eigen::Triplet<double>> entries;
  const auto connect = [&](Index a, Index b) {
    entries.emplace_back(a, a, 1), entries.emplace_back(b, b, 1);
    entries.emplace_back(a, b, -1), entries.emplace_back(b, a, -1);
  };
  int grounded = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const Index here = number(i, j);
      if (here < 0) continue;
      if (m.region(i, j) == grounded)
        ++grounded, entries.emplace_back(here, here, 1);
      if (i + 1 < n && m.open_u(i, j) != 0) connect(here, number(i + 1, j));
      if (j + 1 < n && m.open_v(i, j) != 0) connect(here, number(i, j + 1));
    }
  Eigen::SparseMatrix<double> a(count, count);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

}  // namespace

BoxMasks::BoxMasks(Index n, const std::vector<Obstacle>& obstacles)
    : fluid(Batch<double>::Ones(n, n)),
      open_u(n - 1, n),
      open_v(n, n - 1),
      kept_u(Batch<double>::Ones(n - 1, n)),
      kept_v(Batch<double>::Ones(n, n - 1)),
      region(Batch<int>::Constant(n, n, -1)) {
  for (const Obstacle& o : obstacles) {
    SUITE_CHECK(0 <= o.i0 && o.i0 < o.i1 && o.i1 <= n && 0 <= o.j0 &&
                    o.j0 < o.j1 && o.j1 <= n,
                "an obstacle must be a range of cells of the box");
    fluid.block(o.i0, o.j0, o.i1 - o.i0, o.j1 - o.j0).setZero();
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        if (i + 1 < n) kept_u(i, j) *= kept(o, double(i + 1), double(j) + 0.5);
        if (j + 1 < n) kept_v(i, j) *= kept(o, double(i) + 0.5, double(j + 1));
      }
  }
  open_u = fluid.topRows(n - 1).cwiseProduct(fluid.bottomRows(n - 1));
  open_v = fluid.leftCols(n - 1).cwiseProduct(fluid.rightCols(n - 1));
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (fluid(i, j) != 0 && region(i, j) < 0) flood(*this, i, j, regions++);
}

template <class T>
BoxProjection<T>::BoxProjection(const BoxMasks& m)
    : faces_(m.fluid.rows(), m.fluid.cols()),
      open_(factors(m.open_u, m.open_v)),
      kept_(factors(m.kept_u, m.kept_v)),
      solver_(laplacian(m)) {
  faces_.cells.for_points([&](Index i, Index j, Index at) {
    if (m.fluid(i, j) == 0) return;
    to_.push_back(solver_.position(static_cast<Index>(at_.size())));
    at_.push_back(at);
  });
}

template <class T>
auto BoxProjection<T>::factors(const Batch<double>& u,
                               const Batch<double>& v) const -> Factors {
  Factors f;
  f.u.assign(static_cast<std::size_t>(faces_.cells.size()), T(0));
  f.v = f.u;
  faces_.u.for_points([&](Index i, Index j, Index at) {
    f.u[static_cast<std::size_t>(at)] = static_cast<T>(u(i, j));
  });
  faces_.v.for_points([&](Index i, Index j, Index at) {
    f.v[static_cast<std::size_t>(at)] = static_cast<T>(v(i, j));
  });
  return f;
}

template class BoxProjection<float>;
template class BoxProjection<double>;

}  // namespace physinv::fluid
