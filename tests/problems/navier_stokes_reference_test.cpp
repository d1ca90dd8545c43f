// Every entry of jpo-navier-stokes that is physics.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "problems/fluid/noise.h"
#include "problems/navier_stokes/blast.h"
#include "problems/navier_stokes/box_flow.h"
#include "problems/navier_stokes/navier_stokes.h"
#include "tests/support/mac_cormack_reference.h"

namespace physinv::test {
namespace {

using fluid::BoxMasks;
using fluid::BoxProjection;
using fluid::Edge;

template <class T>
void check_lookup(const Json& entry) {
  using P = fluid::Samples8<T>;
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  const FileTolerance<T> near(entry);
  const Batch<double> field = rows(in.at("field"));
  const fluid::Plane g{field.rows(), field.cols()};
  const auto f = to_plane<P>(g, field);
  const fluid::Lookup<Edge::zero, P> lookup(g);
  const Vector<double> x = vector(in.at("x")), y = vector(in.at("y"));
  Batch<double> found(x.size(), 3), corners(x.size(), 4);
  for (Index k = 0; k < x.size(); ++k) {
    const auto spot = lookup.find(P{} + T(x(k)), P{} + T(y(k)));
    P c[4];
    lookup.read(f.data(), spot, c);
    const auto l = lookup.look(c, spot);
    found.row(k) << double(l.value[1]), double(l.dx[1]), double(l.dy[1]);
    for (int q = 0; q < 4; ++q) corners(k, q) = double(c[q][1]);
  }
  near(found.col(0), vector(out.at("value")), "value");
  near(found.col(1), vector(out.at("d_dx")), "d_dx");
  near(found.col(2), vector(out.at("d_dy")), "d_dy");
  near(corners, rows(out.at("corners")), "corners");
}

std::vector<fluid::Obstacle> boxes(const Json& list) {
  std::vector<fluid::Obstacle> all;
  for (const Json& b : list) all.push_back({b[0], b[1], b[2], b[3]});
  return all;
}

/// A pair of face planes and the memory to work on them.
template <class T>
struct Faces {
  using P = fluid::Samples8<T>;

  Faces(const BoxProjection<T>& box, const Json& u_rows, const Json& v_rows)
      : g(box.faces()),
        u(to_plane<P>(g.u, rows(u_rows))),
        v(to_plane<P>(g.v, rows(v_rows))),
        memory(scratch<P>(g.cells)) {
    u.resize(blank<P>(g.cells).size()), v.resize(u.size());
  }

  fluid::Staggering<Edge::zero> g;
  Packs<P> u, v, memory;
};

template <class T>
void check_projection(const Json& entry) {
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  const FileTolerance<T> near(entry);
  const BoxMasks masks(in.at("N").get<Index>(), boxes(in.at("boxes")));
  EXPECT_EQ(masks.regions, out.at("fluid_components").get<int>());
  near(masks.open_u, rows(out.at("Mu")), "Mu");
  near(masks.open_v, rows(out.at("Mv")), "Mv");
  near(masks.kept_u, rows(out.at("Cu")), "Cu");
  near(masks.kept_v, rows(out.at("Cv")), "Cv");
  const BoxProjection<T> box(masks);
  Faces<T> f(box, in.at("u"), in.at("v"));
  box.project(f.u.data(), f.v.data(), f.memory.data());
  const Batch<double> u = from_plane(f.g.u, f.u), v = from_plane(f.g.v, f.v);
  near(u, rows(out.at("u")), "u");
  near(v, rows(out.at("v")), "v");
  double divergence = 0;
  f.g.cells.for_points([&](Index, Index, Index at) {
    const auto d =
        (f.u[at] - f.u[at - f.g.cells.stride]) + (f.v[at] - f.v[at - 1]);
    divergence = std::max(divergence, std::abs(double(d[0])));
  });
  EXPECT_LE(std::abs(divergence - number(out.at("max_abs_divergence"))),
            near.abs);
  Faces<T> bar(box, in.at("cot_u"), in.at("cot_v"));
  box.pull(bar.u.data(), bar.v.data(), bar.memory.data());
  near(from_plane(f.g.u, bar.u), rows(out.at("u_bar")), "u_bar");
  near(from_plane(f.g.v, bar.v), rows(out.at("v_bar")), "v_bar");
}

template <class T>
void check_steps(const Json& entry) {
  using P = fluid::Samples8<T>;
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  const FileTolerance<T> near(entry, 2e-3);
  const BoxProjection<T> box(
      BoxMasks(in.at("N").get<Index>(), boxes(in.at("boxes"))));
  const BoxFlow<P> flow(box, in.at("lambda_").get<double>());
  const auto steps = in.at("steps").get<std::size_t>();
  Faces<T> f(box, in.at("u"), in.at("v"));
  const Packs<P> zero(f.u.size());
  std::vector<Packs<P>> u(steps + 1, zero), v = u, u_back = u, v_back = u;
  std::vector<std::vector<std::uint8_t>> held(
      2 * steps,
      std::vector<std::uint8_t>(static_cast<std::size_t>(flow.decisions())));
  u[0] = f.u, v[0] = f.v;
  P* const memory = f.memory.data();
  box.project(u[0].data(), v[0].data(), memory);
  const auto step = [&](std::size_t t) {
    return FlowStep<P>{u[t].data(),
                       v[t].data(),
                       u_back[t].data(),
                       v_back[t].data(),
                       held[2 * t].data(),
                       held[2 * t + 1].data()};
  };
  for (std::size_t t = 0; t < steps; ++t)
    flow.advance(step(t), u[t + 1].data(), v[t + 1].data(), memory);
  near(from_plane(f.g.u, u[steps]), rows(out.at("u")), "u");
  near(from_plane(f.g.v, v[steps]), rows(out.at("v")), "v");

  Faces<T> bar(box, in.at("cot_u"), in.at("cot_v"));
  for (std::size_t t = steps; t-- > 0;) {
    auto u_out = zero, v_out = zero;
    flow.retreat(step(t),
                 bar.u.data(),
                 bar.v.data(),
                 u_out.data(),
                 v_out.data(),
                 memory);
    bar.u.swap(u_out), bar.v.swap(v_out);
  }
  box.pull(bar.u.data(), bar.v.data(), memory);
  near(from_plane(f.g.u, bar.u), rows(out.at("u_bar")), "u_bar");
  near(from_plane(f.g.v, bar.v), rows(out.at("v_bar")), "v_bar");
}

Vector<double> flat(const Json& value) {
  if (!value.is_array()) return Vector<double>::Constant(1, number(value));
  Vector<double> all;
  for (const Json& part : value) {
    const Vector<double> v = flat(part);
    all.conservativeResize(all.size() + v.size());
    all.tail(v.size()) = v;
  }
  return all;
}

void check_noise(const Json& entry) {
  const Json& in = entry.at("inputs");
  ASSERT_EQ(in.at("scale"), 10);
  ASSERT_EQ(in.at("size"), 100);
  const fluid::NoiseOptions options{.cells = in.at("N").get<Index>(),
                                    .components = 2,
                                    .cut = 10,
                                    .deviation = in.at("amplitude")};
  FileTolerance<double> near(entry);
  near(fluid::smooth_noise(
           options, flat(in.at("real_normals")), flat(in.at("imag_normals"))),
       flat(entry.at("outputs").at("field")),
       "field");
}

void check_masks(const Json& entry) {
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  const NavierStokesOptions o;
  ASSERT_EQ(in.at("N").get<Index>(), o.cells);
  const auto obstacles = boxes(in.at("boxes"));
  ASSERT_EQ(obstacles.size(), o.obstacles.size());
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    EXPECT_EQ(obstacles[k].i0, o.obstacles[k].i0);
    EXPECT_EQ(obstacles[k].i1, o.obstacles[k].i1);
    EXPECT_EQ(obstacles[k].j0, o.obstacles[k].j0);
    EXPECT_EQ(obstacles[k].j1, o.obstacles[k].j1);
  }
  const BoxMasks m(o.cells, o.obstacles);
  const FileTolerance<double> near(entry);
  const auto check = [&](double got, const char* key) {
    near(Vector<double>::Constant(1, got), flat(out.at(key)), key);
  };
  const auto damped = [&](const Batch<double>& c) {
    Index count = 0;
    for (const double v : c.reshaped())
      if (v > 0 && v < 1) check(v, "damping_value"), ++count;
    return double(count);
  };
  const auto perimeter = [&](const Batch<double>& a, const Batch<double>& b) {
    return (a - b).cwiseAbs().sum();
  };
  check(m.open_u.sum(), "open_u"), check(m.open_v.sum(), "open_v");
  check(m.kept_u.sum(), "sum_Cu"), check(m.kept_v.sum(), "sum_Cv");
  check(damped(m.kept_u), "damped_u"), check(damped(m.kept_v), "damped_v");
  const Index n = o.cells;
  check(perimeter(m.fluid.topRows(n - 1), m.fluid.bottomRows(n - 1)) +
            perimeter(m.fluid.leftCols(n - 1), m.fluid.rightCols(n - 1)),
        "perimeter_faces");
}

template <class T>
void check_blast(const Json& entry) {
  using P = fluid::Samples8<T>;
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  ASSERT_EQ(in.at("cot_u"), "cos(k)");
  ASSERT_EQ(in.at("cot_v"), "sin(k+1)");
  FileTolerance<T> near(entry, 1e-5);
  const NavierStokesOptions o;
  const BlastShape<T> shape(o.cells, o.box, o.height, o.width);
  const fluid::Staggering<Edge::zero> g(o.cells, o.cells);
  const Json& points = in.at("points");
  for (std::size_t e = 0; e < in.at("xi").size(); ++e) {
    const Vector<double> xi = vector(in.at("xi")[e]);
    const Blast<P> b{P{} + T(xi(0)), P{} + T(xi(1)), P{} + T(xi(2))};
    auto u = blank<P>(g.cells), v = u, u_bar = u, v_bar = u;
    shape.add(b, u.data(), v.data());
    const auto count = static_cast<Index>(points.size());
    Vector<double> at_u(count), at_v(count);
    for (Index k = 0; k < count; ++k) {
      const Index at = g.cells.at(points[k][0], points[k][1]);
      at_u(k) = double(u[at][0]), at_v(k) = double(v[at][0]);
      u_bar[at] = P{} + T(std::cos(double(k)));
      v_bar[at] = P{} + T(std::sin(double(k + 1)));
    }
    near(at_u, vector(out.at("u")[e]), "u");
    near(at_v, vector(out.at("v")[e]), "v");
    const auto bar = shape.pull(b, u_bar.data(), v_bar.data());
    near(Eigen::Vector3d(bar.x0[0], bar.vx[0], bar.vy[0]),
         vector(out.at("xi_bar")[e]),
         "xi_bar");
    const Batch<double> all_u = from_plane(g.u, u), all_v = from_plane(g.v, v);
    near(Vector<double>::Constant(1, all_u.sum()),
         flat(out.at("sum_u")[e]),
         "sum_u");
    near(Vector<double>::Constant(1, all_v.sum()),
         flat(out.at("sum_v")[e]),
         "sum_v");
  }
}

/// The initial flow of a scene at all centres, (component, i, j).
Vector<double> wave_flow(const Json& modes, Index n) {
  Vector<double> flow = Vector<double>::Zero(2 * n * n);
  for (const Json& m : modes) {
    const auto c = m[0].get<Index>();
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        flow((c * n + i) * n + j) +=
            number(m[1]) * std::sin(2 * std::numbers::pi *
                                        (number(m[2]) * (double(i) + 0.5) +
                                         number(m[3]) * (double(j) + 0.5)) /
                                        double(n) +
                                    number(m[4]));
  }
  return flow;
}

Vector<double> upper_half(Vector<double> flow, Index n) {
  for (Index line = 0; line < 2 * n; ++line)
    flow.segment(line * n, n / 2).setZero();
  return flow;
}

template <class T>
void check_scene(const Json& entry) {
  const Json &in = entry.at("inputs"), &out = entry.at("outputs");
  const Json& tolerance = entry.at("tolerance");
  constexpr bool kSingle = sizeof(T) == 4;
  const double loss_rel = kSingle ? 1e-3 : number(tolerance.at("loss_rel"));
  const double probe = kSingle ? 1e-2 : number(tolerance.at("probe_abs"));
  const double gradient_rel =
      kSingle ? 5e-2 : number(tolerance.at("grad_rel_to_max"));
  NavierStokesOptions o;
  o.steps = in.at("steps").get<Index>(), o.end_time = in.at("T");
  const NavierStokes<T> problem(o);
  const Index n = o.cells;

  const Vector<double> xi = vector(in.at("xi_true"));
  const Eigen::Vector3d truth(
      std::atanh(xi(0) / 50 - 1), xi(1) / 5, xi(2) / 5 - 1);
  const Vector<double> flow = wave_flow(in.at("modes"), n);
  Workspace work;
  Batch<T> seen(n * n, 1);
  problem.forward(
      Batch<T>(truth.cast<T>()), Batch<T>(flow.cast<T>()), seen, work);
  // Every z sees data in double, so that a float's loss is its own.
  Batch<double> target(n * n, 1);
  NavierStokes<double>(o).forward(truth, flow, target, work);
  expect_near(Vector<double>::Constant(
                  1, 0.5 * seen.template cast<double>().squaredNorm()),
              flat(out.at("obs_norm_half_sq")),
              loss_rel,
              0,
              "obs_norm_half_sq");
  const auto check_probes = [&](const auto& y, const Json& probes) {
    for (const Json& p : probes)
      for (Index c = 0; c < 2; ++c)
        EXPECT_NEAR(double(y((c * n + p[0].get<Index>()) * (n / 2) +
                             p[1].get<Index>())),
                    number(p[static_cast<std::size_t>(2 + c)]),
                    probe);
  };
  check_probes(seen.col(0), out.at("obs_probes"));

  const Batch<T> z = columns(in.at("z")).cast<T>();
  const Index count = z.cols();
  const Batch<T> given = upper_half(flow, n).cast<T>().replicate(1, count);
  const Batch<T> all = target.cast<T>().replicate(1, count);
  Batch<T> y(n * n, count), y_bar = y, z_bar(3, count);
  Vector<double> loss(count);
  Tape tape;
  problem.linearize(z, given, y, tape);
  problem.loss(y, all, loss);
  problem.loss_gradient(y, all, y_bar);
  problem.pullback(tape, y_bar, z_bar, work);
  check_probes(y.col(0), out.at("final_probes_first_z"));
  expect_near(loss, vector(out.at("loss")), loss_rel, 0, "loss");
  const auto check_gradient = [&](const Batch<double>& got, const char* key) {
    const Batch<double> expected = columns(out.at(key));
    expect_near(
        got, expected, 0, gradient_rel * expected.cwiseAbs().maxCoeff(), key);
  };
  Batch<double> gradient = z_bar.template cast<double>();
  check_gradient(gradient, "grad_z");
  for (Index k = 0; k < count; ++k) {
    const double t = std::tanh(double(z(0, k)));
    gradient(0, k) /= 50 * (1 - t * t);
    gradient(1, k) /= 5, gradient(2, k) /= 5;
  }
  check_gradient(gradient, "grad_xi");
  // "informational": the start is prior mean, and the end is better.
  if (out.contains("bfgs")) {
    EXPECT_EQ(flat(out.at("bfgs").at("start_z")), Vector<double>::Zero(3));
    EXPECT_LT(number(out.at("bfgs").at("final_loss")[0]), loss(0));
  }
}

template <void (*F)(const Json&), void (*D)(const Json&)>
void in_both(const Json& entry) {
  {
    SCOPED_TRACE("float");
    F(entry);
  }
  SCOPED_TRACE("double");
  D(entry);
}

TEST(NavierStokesReference, EveryEntry) {
  const std::map<std::string, EntryCheck> checks = {
      {"lookup", in_both<check_lookup<float>, check_lookup<double>>},
      {"mac_cormack",
       in_both<check_mac_cormack<float, Edge::zero>,
               check_mac_cormack<double, Edge::zero>>},
      {"projection",
       in_both<check_projection<float>, check_projection<double>>},
      {"steps", in_both<check_steps<float>, check_steps<double>>},
      {"noise", check_noise},
      {"masks", check_masks},
      {"blast", in_both<check_blast<float>, check_blast<double>>},
      {"scene", in_both<check_scene<float>, check_scene<double>>}};
  const std::set<std::string> of_methods = {
      "g2s", "g2g", "percentile_clip", "boundary_loss", "scores"};
  check_entries("jpo-navier-stokes", checks, of_methods);
}

}  // namespace
}  // namespace physinv::test
