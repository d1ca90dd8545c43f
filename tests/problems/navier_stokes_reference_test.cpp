// Every entry of jpo-navier-stokes that is physics.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "problems/fluid/noise.h"
#include "problems/navier_stokes/blast.h"
#include "problems/navier_stokes/box_flow.h"
#include "problems/navier_stokes/navier_stokes.h"
#include "suite/core/any_problem.h"
#include "tests/support/hig_reference.h"
#include "tests/support/mac_cormack_reference.h"
#include "tests/support/physics.h"

namespace physinv::test {
namespace {

using fluid::BoxMasks;
using fluid::BoxProjection;
using fluid::Edge;

template <class T>
void check_lookup(const Json& entry) {
  using P = fluid::Samples8<T>;
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  const FileTolerance<T> near(entry);
  const Batch<double> field = rows(in.at("field"));
  const fluid::Plane g{field.rows(), field.cols()};
  const auto f = to_plane<P>(g, field);
  const fluid::Lookup<Edge::zero, P> lookup(g);
  const Vector<double> x = vector(in.at("x")), y = vector(in.at("y"), x.size());
  Batch<double> found(x.size(), 3), corners(x.size(), 4);
  for (Index k = 0; k < x.size(); ++k) {
    const auto spot = lookup.find(P{} + T(x(k)), P{} + T(y(k)));
    P c[4];
    lookup.read(f.data(), spot, c);
    const auto l = lookup.interpolate(c, spot);
    found.row(k) << double(l.value[1]), double(l.dx[1]), double(l.dy[1]);
    for (int q = 0; q < 4; ++q) corners(k, q) = double(c[q][1]);
  }
  near(found.col(0), vector(out.at("value")), "value");
  near(found.col(1), vector(out.at("d_dx")), "d_dx");
  near(found.col(2), vector(out.at("d_dy")), "d_dy");
  near(corners, rows(out.at("corners")), "corners");
}

/// Blocks of cells of a box of n x n.
std::vector<fluid::Obstacle> boxes(const Json& list, Index n) {
  std::vector<fluid::Obstacle> all;
  for (const Json& one : list) {
    const std::array<Index, 4> b = one;
    if (0 > b[0] || b[0] > b[1] || b[1] > n || 0 > b[2] || b[2] > b[3] ||
        b[3] > n)
      throw std::runtime_error(one.path() + " is " + one.dump() +
                               ", no block of the box");
    all.push_back({b[0], b[1], b[2], b[3]});
  }
  return all;
}

/// A pair of face planes and the memory to work on them.
template <class T>
struct Faces {
  using P = fluid::Samples8<T>;

  Faces(const BoxProjection<T>& box, const Json& u_rows, const Json& v_rows)
      : g(box.faces()),
        u(to_plane<P>(g.u, rows(u_rows, g.u.rows, g.u.columns))),
        v(to_plane<P>(g.v, rows(v_rows, g.v.rows, g.v.columns))),
        memory(scratch<P>(g.cells)) {
    u.resize(blank<P>(g.cells).size()), v.resize(u.size());
  }

  fluid::Staggering<Edge::zero> g;
  Packs<P> u, v, memory;
};

template <class T>
void check_projection(const Json& entry) {
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  const FileTolerance<T> near(entry);
  const Index n = in.at("N");
  ASSERT_GE(n, 2);
  const BoxMasks masks(n, boxes(in.at("boxes"), n));
  EXPECT_EQ(masks.regions, number(out.at("fluid_components")));
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
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  const FileTolerance<T> near(entry, 2e-3);
  const Index n = in.at("N"), count = in.at("steps");
  ASSERT_GE(n, 2);
  ASSERT_GE(count, 0);
  const BoxProjection<T> box(BoxMasks(n, boxes(in.at("boxes"), n)));
  const BoxFlow<P> flow(box, number(in.at("lambda_")));
  const auto steps = static_cast<std::size_t>(count);
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

/// Section 5: modes of k^2 = (scale / size)^2 (mx^2 + my^2) up to 0.1 are cut.
Index cut_of(double scale, double size) {
  return static_cast<Index>(0.1 * (size / scale) * (size / scale) + 1e-9);
}

void check_noise(const Json& entry) {
  const Json in = entry.at("inputs");
  const Json real = in.at("real_normals"), imaginary = in.at("imag_normals");
  const fluid::NoiseOptions options{
      .cells = in.at("N"),
      .components = static_cast<Index>(real.size()),
      .cut = cut_of(in.at("scale"), in.at("size")),
      .deviation = in.at("amplitude")};
  ASSERT_GE(options.cells, 1);
  const Index modes = options.components * options.cells * options.cells;
  const Vector<double> re = flat(real, modes), im = flat(imaginary, modes);
  const FileTolerance<double> near(entry);
  near(fluid::smooth_noise(options, re, im),
       flat(entry.at("outputs").at("field")),
       "field");
}

void check_masks(const Json& entry) {
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  const Index n = in.at("N");
  ASSERT_GE(n, 2);
  const BoxMasks m(n, boxes(in.at("boxes"), n));
  const FileTolerance<double> near(entry);
  const auto check = [&](double got, const char* key) {
    near(got, out.at(key), key);
  };
  const double value = number(out.at("damping_value"));
  const auto damped = [&](const Batch<double>& c) {
    Index count = 0;
    for (const double v : c.reshaped())
      if (v > 0 && v < 1) check(v, "damping_value"), ++count;
    return double(count);
  };
  EXPECT_TRUE(0 < value && value < 1) << value;
  const auto perimeter = [&](const Batch<double>& a, const Batch<double>& b) {
    return (a - b).cwiseAbs().sum();
  };
  check(m.open_u.sum(), "open_u"), check(m.open_v.sum(), "open_v");
  check(m.kept_u.sum(), "sum_Cu"), check(m.kept_v.sum(), "sum_Cv");
  check(damped(m.kept_u), "damped_u"), check(damped(m.kept_v), "damped_v");
  check(perimeter(m.fluid.topRows(n - 1), m.fluid.bottomRows(n - 1)) +
            perimeter(m.fluid.leftCols(n - 1), m.fluid.rightCols(n - 1)),
        "perimeter_faces");
}

template <class T>
void check_blast(const Json& entry) {
  using P = fluid::Samples8<T>;
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  expect_formula(in, "cot_u", "cos(k)");
  expect_formula(in, "cot_v", "sin(k+1)");
  FileTolerance<T> near(entry, 1e-5);
  const NavierStokesOptions o;
  const BlastShape<T> shape(o.cells, o.box, o.height, o.width);
  const fluid::Staggering<Edge::zero> g(o.cells, o.cells);
  const std::vector<std::array<Index, 2>> points = in.at("points");
  const std::vector<std::array<double, 3>> blasts = in.at("xi");
  for (std::size_t e = 0; e < blasts.size(); ++e) {
    const auto& xi = blasts[e];
    const Blast<P> b{P{} + T(xi[0]), P{} + T(xi[1]), P{} + T(xi[2])};
    auto u = blank<P>(g.cells), v = u, u_bar = u, v_bar = u;
    shape.add(b, u.data(), v.data());
    const auto count = static_cast<Index>(points.size());
    Vector<double> at_u(count), at_v(count);
    for (Index k = 0; k < count; ++k) {
      const auto [i, j] = points[std::size_t(k)];
      ASSERT_TRUE(0 <= i && i < o.cells && 0 <= j && j < o.cells);
      const Index at = g.cells.at(i, j);
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
    near(all_u.sum(), out.at("sum_u")[e], "sum_u");
    near(all_v.sum(), out.at("sum_v")[e], "sum_v");
  }
}

/// The initial flow of a scene at all centres, (component, i, j).
Vector<double> wave_flow(const Json& modes, Index n) {
  Vector<double> flow = Vector<double>::Zero(2 * n * n);
  for (const Json& mode : modes) {
    const Index c = mode[0];
    const double a = mode[1], p = mode[2], q = mode[3], phase = mode[4];
    if (c != 0 && c != 1)
      throw std::runtime_error(mode.path() + " of " + mode[0].dump());
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        flow((c * n + i) * n + j) +=
            a * std::sin(2 * std::numbers::pi *
                             (p * (double(i) + 0.5) + q * (double(j) + 0.5)) /
                             double(n) +
                         phase);
  }
  return flow;
}

Vector<double> upper_half(Vector<double> flow, Index n) {
  for (Index line = 0; line < 2 * n; ++line)
    flow.segment(line * n, n / 2).setZero();
  return flow;
}

/// A run of BFGS, which another line search may end elsewhere: it starts where
/// it says, and the end has the stored loss and is better.
void check_informational(const AnyProblem<double>& problem,
                         const Batch<double>& given,
                         const Batch<double>& target,
                         const Json& run) {
  const auto losses = [&](const Batch<double>& z) {
    Batch<double> y(target.rows(), z.cols());
    Vector<double> loss(z.cols());
    Workspace work;
    problem.forward(z, given.col(0).replicate(1, z.cols()), y, work);
    problem.loss(y, target.col(0).replicate(1, z.cols()), loss);
    return loss;
  };
  const Batch<double> start = columns(run.at("start_z"), 3),
                      end = columns(run.at("final_z"), 3, start.cols());
  const Vector<double> final_loss = vector(run.at("final_loss"), start.cols()),
                       iterations = vector(run.at("iterations"), start.cols());
  EXPECT_TRUE(Comparator(1e-6, 0)(losses(end), final_loss));
  EXPECT_TRUE((final_loss.array() <= losses(start).array()).all());
  EXPECT_GE(number(run.at("evaluations")), iterations.sum());
}

template <class T>
void check_scene(const Json& entry) {
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  const Json tolerance = entry.at("tolerance");
  constexpr bool kFloat = sizeof(T) == 4;
  const double loss_rel = kFloat ? 1e-3 : number(tolerance.at("loss_rel"));
  const double probe = kFloat ? 1e-2 : number(tolerance.at("probe_abs"));
  const double gradient_rel =
      kFloat ? 5e-2 : number(tolerance.at("grad_rel_to_max"));
  NavierStokesOptions o;
  o.steps = in.at("steps").get<Index>(), o.end_time = in.at("T");
  const AnyProblem<T> problem(problems::navier_stokes(o));
  const Index n = o.cells;

  const Vector<double> xi = vector(in.at("xi_true"), 3);
  const Eigen::Vector3d truth(
      std::atanh(xi(0) / 50 - 1), xi(1) / 5, xi(2) / 5 - 1);
  const Vector<double> flow = wave_flow(in.at("modes"), n);
  Workspace work;
  Batch<T> seen(n * n, 1);
  problem.forward(
      Batch<T>(truth.cast<T>()), Batch<T>(flow.cast<T>()), seen, work);
  // Every z sees data in double, so that a float's loss is its own.
  Batch<double> target(n * n, 1);
  AnyProblem<double>(problems::navier_stokes(o))
      .forward(truth, flow, target, work);
  EXPECT_TRUE(
      Comparator(loss_rel, 0)(0.5 * seen.template cast<double>().squaredNorm(),
                              number(out.at("obs_norm_half_sq"))));
  const auto check_probes = [&](const auto& y, const Json& probes) {
    for (const Json& p : probes) {
      const Index i = p[0], j = p[1];
      ASSERT_TRUE(0 <= i && i < n && 0 <= j && j < n / 2) << p;
      for (Index c = 0; c < 2; ++c)
        EXPECT_NEAR(
            double(y((c * n + i) * (n / 2) + j)), number(p[2 + c]), probe);
    }
  };
  check_probes(seen.col(0), out.at("obs_probes"));

  const Batch<T> z = columns(in.at("z"), 3).cast<T>();
  const Index count = z.cols();
  ASSERT_GE(count, 1);
  const Batch<T> given = upper_half(flow, n).cast<T>().replicate(1, count);
  const Batch<T> all = target.cast<T>().replicate(1, count);
  const auto [y, loss, z_bar] = Physics(problem).losses(z, given, all);
  check_probes(y.col(0), out.at("final_probes_first_z"));
  // Where a z is the truth, rounding of the data is all that float has left.
  expect_near(
      loss, vector(out.at("loss")), loss_rel, kFloat ? 1e-5 : 0, "loss");
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
  if constexpr (!kFloat) {
    if (out.contains("bfgs"))
      check_informational(problem, given, all, out.at("bfgs"));
  }
}

TEST(NavierStokesReference, EveryEntry) {
  const std::map<std::string, EntryCheck> checks = {
      {"lookup", in_both(check_lookup<float>, check_lookup<double>)},
      {"mac_cormack",
       in_both(check_mac_cormack<float, Edge::zero>,
               check_mac_cormack<double, Edge::zero>)},
      {"projection",
       in_both(check_projection<float>, check_projection<double>)},
      {"steps", in_both(check_steps<float>, check_steps<double>)},
      {"noise", check_noise},
      {"masks", check_masks},
      {"blast", in_both(check_blast<float>, check_blast<double>)},
      {"scene", in_both(check_scene<float>, check_scene<double>)}};
  const std::set<std::string> of_methods = {
      "g2s", "g2g", "percentile_clip", "boundary_loss", "scores"};
  check_entries("jpo-navier-stokes", checks, of_methods);
}

}  // namespace
}  // namespace physinv::test
