// The kernels that problems of flow share.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "problems/fluid/box_projection.h"
#include "problems/marker_flow/periodic_projection.h"
#include "tests/support/mac_cormack_reference.h"

namespace physinv::test {
namespace {

using fluid::Edge;
using fluid::Plane;

/// Numbers without structure, between -1 and 1.
double rough(Index k) { return std::sin(12.9898 * double(k * k + 3 * k + 1)); }

Batch<double> rough(Index rows, Index columns, Index shift) {
  return Batch<double>::NullaryExpr(rows, columns, [=](Index i, Index j) {
    return rough(shift + 31 * i + 7 * j);
  });
}

template <class T>
class FluidIn : public testing::Test {
 protected:
  static constexpr double kEps = sizeof(T) == 8 ? 1e-13 : 1e-5;
};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(FluidIn, Scalars);

/// Two pairs of face planes through a projection: what it must be.
template <class T, class G, class F>
void expect_projection(const G& g, F&& project, double eps) {
  using P = fluid::Samples8<T>;
  const auto faces = [&](Index shift) {
    auto u = to_plane<P>(g.u, rough(g.u.rows, g.u.columns, shift));
    auto v = to_plane<P>(g.v, rough(g.v.rows, g.v.columns, shift + 5));
    u.resize(blank<P>(g.cells).size()), v.resize(u.size());
    return std::pair(u, v);
  };
  const auto dot = [&](const auto& a, const auto& b) {
    const auto part = [](const Plane& plane, const auto& x, const auto& y) {
      return from_plane(plane, x).cwiseProduct(from_plane(plane, y)).sum();
    };
    return part(g.u, a.first, b.first) + part(g.v, a.second, b.second);
  };
  auto memory = scratch<P>(g.cells);
  const auto projected = [&](auto f) {
    project(f.first.data(), f.second.data(), memory.data());
    return f;
  };
  const auto a = faces(1), b = faces(1000);
  const auto once = projected(a), twice = projected(once), other = projected(b);
  EXPECT_LE((from_plane(g.u, once.first) - from_plane(g.u, twice.first))
                .cwiseAbs()
                .maxCoeff(),
            eps);
  EXPECT_LE((from_plane(g.v, once.second) - from_plane(g.v, twice.second))
                .cwiseAbs()
                .maxCoeff(),
            eps);
  EXPECT_NEAR(dot(once, b), dot(a, other), eps * dot(a, a));
  EXPECT_LT(dot(once, once), 0.9 * dot(a, a));  // and not the identity
}

TYPED_TEST(FluidIn, ProjectionsAreOrthogonal) {
  for (const auto& obstacles :
       {std::vector<fluid::Obstacle>{},
        std::vector<fluid::Obstacle>{{3, 6, 2, 9}, {6, 9, 9, 11}},
        // A closed room in the corner, and one cell enclosed.
        std::vector<fluid::Obstacle>{{0, 5, 4, 5},
                                     {4, 5, 0, 5},
                                     {8, 11, 8, 9},
                                     {8, 11, 10, 11},
                                     {8, 9, 9, 10},
                                     {10, 11, 9, 10}}}) {
    const fluid::BoxMasks masks(16, obstacles);
    EXPECT_EQ(masks.regions, obstacles.size() > 2 ? 3 : 1);
    const fluid::BoxProjection<TypeParam> box(masks);
    expect_projection<TypeParam>(
        box.faces(),
        [&](auto... planes) { box.orthogonal(planes...); },
        this->kEps);
  }
  const fluid::PeriodicProjection<TypeParam> periodic(16);
  expect_projection<TypeParam>(
      periodic.faces(),
      [&](auto... planes) { periodic.project(planes...); },
      this->kEps);
}

TYPED_TEST(FluidIn, CholeskySolves) {
  const Index n = 40;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 5);
    for (const Index j : {(i + 1) % n, (i * i + 7) % n}) {
      if (i == j) continue;
      entries.emplace_back(i, j, 0.5 * rough(i)),
          entries.emplace_back(j, i, 0.5 * rough(i));
    }
  }
  Eigen::SparseMatrix<double> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  const fluid::SparseCholesky<TypeParam> solver(a);
  using P = fluid::Samples8<TypeParam>;
  std::vector<P> x(n);
  const Vector<double> truth = rough(n, 1, 3), b = a * truth;
  for (Index i = 0; i < n; ++i)
    x[solver.position(i)] = P{} + static_cast<TypeParam>(b(i));
  solver.solve(x.data());
  for (Index i = 0; i < n; ++i)
    EXPECT_NEAR(x[solver.position(i)][2], truth(i), this->kEps);
}

/// What `advect` makes of a rotation by v of a smooth bump, on n cells.
double error_of_advection(Index n) {
  const double dt = 0.5 / double(n), turns = 2 * std::numbers::pi;
  const auto wave = [=](double x, double y) {
    return std::sin(turns * x) + std::cos(turns * (x + y));
  };
  Batch<double> field(n, n), exact(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const double x = double(i) / double(n), y = double(j) / double(n);
      field(i, j) = wave(x, y), exact(i, j) = wave(x - 0.7 * dt, y - 0.4 * dt);
    }
  const Batch<double> one = Batch<double>::Ones(n, n);
  const Advected<double, Edge::periodic> a(
      field, 0.7 * one, 0.4 * one, dt * double(n), one);
  // The limiter is of first order at the extremes; it acts on few points.
  const Batch<double> off = (a.of(a.out) - exact).cwiseAbs();
  EXPECT_LT(a.limited().mean(), 0.2);
  return (a.limited().array() == 0).select(off, 0).maxCoeff();
}

/// One step leaves an error of third order, many of them of second.
TEST(Fluid, MacCormackIsOfSecondOrder) {
  const double coarse = error_of_advection(64);
  EXPECT_GT(std::log2(coarse / error_of_advection(128)), 2.7);
}

/// Of arbitrary fields and places: large displacements, limits, borders.
template <Edge kEdge>
void expect_adjoint() {
  using P = fluid::Samples8<double>;
  const Index rows = 9, columns = 7;
  const Plane g{rows, columns};
  const Batch<double> f = rough(rows, columns, 1),
                      x = 2 * rough(rows, columns, 70),
                      y = 2 * rough(rows, columns, 300),
                      bar = rough(rows, columns, 500);
  const Advected<double, kEdge> a(f, x, y, 1.3, bar);
  EXPECT_GT(a.limited().sum(), 3);
  auto f_dot = to_plane<P>(g, rough(rows, columns, 700));
  if (kEdge == Edge::periodic) wrap(g, f_dot.data());
  const auto x_dot = to_plane<P>(g, rough(rows, columns, 800)),
             y_dot = to_plane<P>(g, rough(rows, columns, 900));
  const auto vx = to_plane<P>(g, x), vy = to_plane<P>(g, y);
  auto out_dot = blank<P>(g), memory = scratch<P>(g);
  a.scheme.push(a.f.data(),
                a.s.data(),
                GivenVelocity<P>{vx.data(), vy.data()},
                a.decisions.data(),
                f_dot.data(),
                GivenVelocity<P>{x_dot.data(), y_dot.data()},
                out_dot.data(),
                memory.data());
  const auto dot = [&](const Packs<P>& p, const Packs<P>& q) {
    return from_plane(g, p).cwiseProduct(from_plane(g, q)).sum();
  };
  const double there = dot(out_dot, to_plane<P>(g, bar));
  const double back =
      dot(f_dot, a.f_bar) + dot(x_dot, a.x_bar) + dot(y_dot, a.y_bar);
  EXPECT_NEAR(there, back, 1e-12 * std::abs(there));
  // The tangent is the derivative: differences far below the kinks.
  const double h = 1e-8;
  const auto moved = [&](double times) {
    const auto part = [&](const Packs<P>& p) -> Batch<double> {
      return from_plane(g, p) * times;
    };
    const Advected<double, kEdge> m(
        f + part(f_dot), x + part(x_dot), y + part(y_dot), 1.3, bar);
    return m.of(m.out);
  };
  const Batch<double> difference = (moved(h) - moved(-h)) / (2 * h);
  EXPECT_LE((difference - from_plane(g, out_dot)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Fluid, AdjointOfMacCormack) {
  expect_adjoint<Edge::zero>();
  expect_adjoint<Edge::periodic>();
}

/// A sample's bits depend on nothing but itself, wherever it looks.
TYPED_TEST(FluidIn, PlacesFarAwayAreSafe) {
  using T = TypeParam;
  using P = fluid::Samples8<T>;
  const Plane g{6, 6};
  auto f = to_plane<P>(g, rough(6, 6, 1));
  const fluid::Lookup<Edge::zero, P> walled(g);
  const fluid::Lookup<Edge::periodic, P> periodic(g);
  for (const T far : {T(1e4), T(1e9), T(1e30), std::numeric_limits<T>::max()})
    for (const T x : {far, -far}) {
      EXPECT_EQ(walled.interpolate(f.data(), walled.find(P{} + x, P{} + T(2)))
                    .value[0],
                T(0));
      const auto found =
          periodic.interpolate(f.data(), periodic.find(P{} + x, P{} + T(2)));
      EXPECT_LE(std::abs(found.value[0]), T(1));
    }
  wrap(g, f.data());
  const auto at = [&](T x, T y) {
    return periodic.interpolate(f.data(), periodic.find(P{} + x, P{} + y))
        .value[3];
  };
  EXPECT_NEAR(at(T(2.25) - 60, T(1.5) + 36), at(T(2.25), T(1.5)), 1e-5);
}

template <class T>
void check_stagger_project(const Json& entry) {
  using P = fluid::Samples8<T>;
  const Json out = entry.at("outputs"),
             centred = entry.at("inputs").at("centred");
  const FileTolerance<T> near(entry);
  const auto n = static_cast<Index>(centred[0].size());
  const Batch<double> cx = rows(centred[0], n, n), cy = rows(centred[1], n, n);
  Batch<double> u(n, n), v(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      u(i, j) = 0.5 * (cx((i + n - 1) % n, j) + cx(i, j));
      v(i, j) = 0.5 * (cy(i, (j + n - 1) % n) + cy(i, j));
    }
  near(u, rows(out.at("staggered_u")), "staggered_u");
  near(v, rows(out.at("staggered_v")), "staggered_v");
  const fluid::PeriodicProjection<T> projection(n);
  const auto& g = projection.faces();
  auto pu = to_plane<P>(g.u, u), pv = to_plane<P>(g.v, v);
  auto memory = scratch<P>(g.cells);
  projection.project(pu.data(), pv.data(), memory.data());
  near(from_plane(g.u, pu), rows(out.at("u")), "u");
  near(from_plane(g.v, pv), rows(out.at("v")), "v");
  wrap(g.u, pu.data()), wrap(g.v, pv.data());
  double divergence = 0;
  g.cells.for_points([&](Index, Index, Index at) {
    const auto d = (pu[at + g.u.stride] - pu[at]) + (pv[at + 1] - pv[at]);
    divergence = std::max(divergence, std::abs(double(d[0])));
  });
  EXPECT_LE(std::abs(divergence - number(out.at("max_abs_divergence"))),
            near.abs);
}

template <class T>
void check_periodic() {
  const std::map<std::string, EntryCheck> checks = {
      {"mac_cormack_periodic", check_mac_cormack<T, Edge::periodic>},
      {"stagger_project", check_stagger_project<T>}};
  const std::set<std::string> of_the_problem = {"step",
                                                "frequency_loss",
                                                "vortex_moment",
                                                "scene",
                                                "u_net",
                                                "discretise",
                                                "adam"};
  check_entries("sip-fluid", checks, of_the_problem);
}

/// What the kernels themselves answer for.
TYPED_TEST(FluidIn, PeriodicReference) { check_periodic<TypeParam>(); }

}  // namespace
}  // namespace physinv::test
