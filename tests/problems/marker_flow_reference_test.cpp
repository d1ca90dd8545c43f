// The vectors of sip-fluid that are physics; kernels of flow, the network and
// Adam have tests of their own.
#include <array>
#include <numbers>

#include "problems/marker_flow/marker_flow.h"
#include "problems/marker_flow/periodic_flow.h"
#include "suite/core/any_problem.h"
#include "tests/support/mac_cormack_reference.h"
#include "tests/support/physics.h"

namespace physinv::test {
namespace {

const std::string kFluidId = "sip-fluid";

/// Planes of a step and of what it makes, and back.
template <class T>
struct StepBench {
  using P = fluid::Samples8<T>;

  StepBench(Index cells, double lambda)
      : flow(cells, lambda), memory(fluid::kScratchPlanes * size()) {
    for (auto& f : planes) f = blank<P>(flow.plane());
    for (auto& h : held) h.resize(std::size_t(flow.decisions()));
  }
  std::size_t size() const { return std::size_t(flow.plane().size()); }
  void set(int plane, const Batch<double>& a) {
    planes[plane] = to_plane<P>(flow.plane(), a);
    wrap(flow.plane(), planes[plane].data());
  }
  MarkerStep<P> step() {
    return {at(0),
            at(1),
            at(2),
            at(3),
            at(4),
            at(5),
            energies,
            held[0].data(),
            held[1].data(),
            held[2].data()};
  }
  MarkerState<P> state(int first) {
    return {at(first), at(first + 1), at(first + 2)};
  }
  P* at(int plane) { return planes[plane].data(); }
  Batch<double> get(int plane) const {
    return from_plane(flow.plane(), planes[plane]);
  }
  double energy(int first) {
    return double(flow.energy(at(first), at(first + 1))[0]);
  }
  double divergence(int first) {
    const Batch<double> u = get(first), v = get(first + 1);
    const Index n = u.rows();
    double most = 0;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        most = std::max(most,
                        std::abs(u((i + 1) % n, j) - u(i, j) +
                                 v(i, (j + 1) % n) - v(i, j)));
    return most;
  }

  PeriodicFlow<P> flow;
  Packs<P> planes[15], memory;
  P energies[2];
  std::vector<std::uint8_t> held[3];
};

template <class T>
void check_step(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("outputs");
  const FileTolerance<T> near(entry, 1e-4);
  const auto n = Index(in.at("m").size());
  StepBench<T> bench(n, in.at("lambda_"));
  const char* names[] = {"u", "v", "m"};
  for (int k = 0; k < 3; ++k) {
    bench.set(k, rows(in.at(names[k]), n, n));
    bench.planes[9 + k] = to_plane<fluid::Samples8<T>>(
        bench.flow.plane(), rows(in.at(std::string("cot_") + names[k]), n, n));
  }
  bench.flow.advance(bench.step(), bench.state(6), bench.memory.data());
  near(bench.energy(0), want.at("energy_in"), "energy_in");
  near(bench.energy(6), want.at("energy_out"), "energy_out");
  bench.flow.retreat(bench.step(),
                     bench.state(6),
                     bench.state(9),
                     bench.state(12),
                     bench.memory.data());
  for (int k = 0; k < 3; ++k) {
    near(bench.get(6 + k), rows(want.at(names[k])), names[k]);
    const std::string bar = std::string(names[k]) + "_bar";
    near(bench.get(12 + k), rows(want.at(bar)), bar.c_str());
  }
}

void check_loss(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("outputs");
  const FileTolerance<double> near(entry);
  const auto cells = Index(in.at("difference").size());
  const Vector<double> difference = field(in.at("difference"), cells, cells);
  const FrequencyLoss loss(cells, in.at("falloff"), in.at("threshold"));
  Vector<double> gradient(difference.size());
  near(loss(difference, gradient.data()) + loss.floor(),
       want.at("value"),
       "value");
  near(loss.floor(), want.at("floor"), "floor");
  near(gradient, field(want.at("grad")), "grad");
}

void check_vortex(const Json& entry) {
  const Json want = entry.at("outputs");
  EXPECT_TRUE(entry.at("inputs").empty()) << entry.at("inputs");
  const FileTolerance<double> near(entry);
  const MarkerFlowOptions o;
  const Index n = o.cells;
  const Vortex vortex = o.turning();
  Vector<double> all(2 * n * n);
  for (Index row = 0; row < all.size(); ++row)
    all(row) = vortex(int(row / (n * n)), row % (n * n) / n, row % n);
  near(vortex.strength(all) * vortex.moment, want.at("value"), "moment");
  for (const Json& probe : want.at("swirl_probes"))
    for (int c = 0; c < 2; ++c)
      near(vortex(c, probe[0], probe[1]), probe[2 + c], "swirl");
  const FrequencyLoss loss(n, o.falloff, o.threshold);
  const auto wave = [&](Index k) { return k < n / 2 ? k : k - n; };
  for (const Json& probe : want.at("loss_weight_probes"))
    near(loss.weight(wave(probe[0]), wave(probe[1])), probe[2], "weight");
}

void check_discretise(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("outputs");
  const Index n = in.at("N");
  ASSERT_GE(n, 1);
  const MarkerGrid grid{n, 2.0 * double(n)};  // cells 2 wide, as in scenes
  const double fill = in.at("fill_fraction");
  EXPECT_EQ(marked_cells(grid, fill), want.at("rank_count").get<Index>());
  const MarkerPatch patch{
      {in.at("centre")[0], in.at("centre")[1]}, in.at("half"), fill};
  const Vector<double> found = marker(grid, patch, field(in.at("noise"), n, n));
  EXPECT_EQ(found, field(want.at("marker")));
  const MarkerPoint mass = centre_of_mass(grid, found);
  const FileTolerance<double> near(entry);
  near(Eigen::Vector2d(mass.x, mass.y), vector(want.at("com")), "com");
}

// ---- scenes -----------------------------------------------------------------

constexpr Index kCells = 64, kPlane = kCells * kCells;

Vector<double> scene_marker(const Json& rule) {
  const MarkerGrid grid;
  const auto of = [&](const char* key) { return number(rule.at(key)); };
  Vector<double> m = Vector<double>::Zero(kPlane);
  for (Index i = 0; i < kCells; ++i)
    for (Index j = 0; j < kCells; ++j) {
      const double x = grid.at(i), y = grid.at(j), p = of("phase");
      const bool near = std::abs(x - of("cx")) <= of("half") &&
                        std::abs(y - of("cy")) <= of("half");
      const double wave = std::sin(of("a") * x + p) * std::cos(of("b") * y - p);
      m(i * kCells + j) = near && wave > of("threshold") ? 1 : 0;
    }
  return m;
}

Vector<double> scene_velocity(const Json& rule) {
  const Vortex vortex;
  const std::array<double, 2> uniform = rule.at("uniform");
  const double strength = rule.at("vortex");
  const std::vector<std::array<double, 5>> modes = rule.at("modes");
  Vector<double> c(2 * kPlane);
  for (Index row = 0; row < c.size(); ++row) {
    const Index k = row / kPlane, i = row % kPlane / kCells, j = row % kCells;
    c(row) = uniform[std::size_t(k)] + strength * vortex(int(k), i, j);
    for (const auto& [component, a, p, q, phase] : modes) {
      if (component != double(k)) continue;
      const double turns = p * (double(i) + 0.5) + q * (double(j) + 0.5);
      c(row) += a * std::sin(2 * std::numbers::pi * turns / kCells + phase);
    }
  }
  return c;
}

/// Tolerances of a scene: the file's in double, float's own otherwise.
struct SceneTolerance {
  SceneTolerance(const Json& entry, bool single) {
    const Json t = entry.at("tolerance");
    loss = single ? 1e-5 : number(t.at("loss_rel"));
    gradient = single ? 1e-2 : number(t.at("grad_rel_to_max"));
    sum = single ? 5e-2 : gradient;
    length = single ? 1e-3 : gradient;
    probe = single ? 2e-5 : number(t.at("probe_abs"));
    mass = single ? 1e-3 : probe;
    sip = single ? 1e-5 : number(t.at("sip_rel"));
    vortex = single ? 1e-3 : sip;
    exact = single ? 1e-5 : loss;
    kept = single ? 1e-5 : 1e-12;
    divergence = single ? 1e-5 : 1e-11;
  }
  double loss, gradient, sum, length;  ///< of the gradient
  double probe, mass;                  ///< of the marker, its sum
  double sip, vortex;                  ///< the correction is a small difference
  double exact, kept, divergence;
};

/// The problem at a scene's guess.
template <class T>
struct Scene {
  explicit Scene(const Json& in)
      : given(scene_marker(in.at("marker")).cast<T>()),
        truth(scene_velocity(in.at("truth")).cast<T>()),
        guess(scene_velocity(in.at("guess")).cast<T>()) {
    target = at(truth);
    found = Physics(problem).losses(guess, given, target);
  }
  Batch<T> at(const Batch<T>& x, Index steps = 8) {
    const MarkerFlowOptions o;
    const AnyProblem<T> until(problems::marker_flow(
        {.end_time = o.end_time * double(steps) / double(o.steps),
         .steps = steps}));
    return Physics(until).forward(x, given);
  }
  Vector<double> inverse(bool timed) {
    const AnyProblem<T> other(problems::marker_flow({.timed_path = timed}));
    return Physics(other).invert(target, given, guess).template cast<double>();
  }

  AnyProblem<T> problem{problems::marker_flow()};
  Batch<T> given, truth, guess, target;
  typename Physics<AnyProblem<T>&>::Losses found;
};

Vector<double> mass_of(const Batch<double>& m) {
  const MarkerPoint p = centre_of_mass({}, m.col(0));
  return Eigen::Vector2d(p.x, p.y);
}

template <class T>
void check_scene(const Json& entry) {
  const Json want = entry.at("outputs"), sip = want.at("sip");
  const SceneTolerance is(entry, sizeof(T) == 4);
  Scene<T> scene(entry.at("inputs"));
  const auto close = [](double got, const Json& expected, double by) {
    EXPECT_TRUE(Comparator(0, by)(got, number(expected)));
  };
  const auto relative = [&](double got, const Json& expected, double by) {
    close(got, expected, by * std::abs(number(expected)));
  };
  const auto at_probes = [&](const Json& probes, auto&& check) {
    for (const Json& p : probes) {
      const Index i = p[0], j = p[1];
      ASSERT_TRUE(0 <= i && i < kCells && 0 <= j && j < kCells) << p;
      check(i * kCells + j, p);
    }
  };
  const Batch<double> target = scene.target.template cast<double>(),
                      seen = scene.found.y.template cast<double>(),
                      g = scene.found.x_bar.template cast<double>(),
                      x = scene.guess.template cast<double>();
  EXPECT_EQ(double(scene.given.sum()), number(want.at("cells_set")));
  const auto place = [&](const Batch<double>& m, const Json& expected) {
    const Vector<double> got = mass_of(m);
    for (int c = 0; c < 2; ++c)
      close(got(c), expected[std::size_t(c)], is.probe);
  };
  place(scene.given.template cast<double>(), want.at("com0"));
  place(target, want.at("com_target"));
  close(target.sum(), want.at("target_sum"), is.mass);
  at_probes(want.at("target_probes"),
            [&](Index a, const Json& p) { close(target(a), p[2], is.probe); });
  at_probes(want.at("final_probes"),
            [&](Index a, const Json& p) { close(seen(a), p[2], is.probe); });
  ASSERT_EQ(want.at("com_forward").size(), 8U) << "steps of a scene";
  for (Index t = 1; t <= 8; ++t)
    place(scene.at(scene.guess, t).template cast<double>(),
          want.at("com_forward")[std::size_t(t - 1)]);
  const MarkerFlowOptions o;
  const double floor = FrequencyLoss(o.cells, o.falloff, o.threshold).floor();
  relative(scene.found.loss(0) + floor, want.at("loss"), is.loss);

  const double most = g.cwiseAbs().maxCoeff();
  at_probes(want.at("grad_probes"), [&](Index a, const Json& p) {
    close(g(a), p[2], is.gradient * most);
    close(g(kPlane + a), p[3], is.gradient * most);
  });
  relative(g.norm(), want.at("grad_l2"), is.length);
  close(g.topRows(kPlane).sum(), want.at("grad_sum")[0], is.sum * most);
  close(g.bottomRows(kPlane).sum(), want.at("grad_sum")[1], is.sum * most);

  StepBench<T> bench(kCells, 0.125);
  bench.set(3, x.topRows(kPlane).reshaped(kCells, kCells).transpose());
  bench.set(4, x.bottomRows(kPlane).reshaped(kCells, kCells).transpose());
  bench.flow.to_faces(
      bench.at(3), bench.at(4), bench.at(0), bench.at(1), bench.memory.data());
  relative(bench.energy(0), want.at("final_energy"), is.exact);
  for (int t = 0; t < 8; ++t) {
    const double before = bench.energy(0);
    bench.flow.advance(bench.step(), bench.state(6), bench.memory.data());
    for (int k = 0; k < 3; ++k) std::swap(bench.planes[k], bench.planes[6 + k]);
    EXPECT_NEAR(bench.energy(0), before, is.kept * before);
    const double fastest = bench.get(0).cwiseAbs().maxCoeff();
    EXPECT_LE(bench.divergence(0), is.divergence * fastest);
  }
  relative(bench.energy(0), want.at("final_energy"), is.exact);
  const Batch<double> off = x - scene.truth.template cast<double>();
  relative((off.topRows(kPlane).array().square() +
            off.bottomRows(kPlane).array().square())
               .sqrt()
               .mean(),
           want.at("x_mae"),
           is.exact);

  const Vortex vortex;
  const Vector<double> found = scene.inverse(false);
  const auto corrected = [&](const Vector<double>& c) {  // uniform + s1 W
    return (c(32 * kCells + 40) - c(32 * kCells + 23)) /
           (vortex(0, 32, 40) - vortex(0, 32, 23));
  };
  relative(vortex.strength(x), sip.at("s_initial"), is.sip);
  relative(corrected(found), sip.at("s_corrected"), is.vortex);
  relative(corrected(scene.inverse(true)),
           sip.at("s_corrected_timed_path"),
           is.vortex);
  const double s = corrected(found);
  for (int c = 0; c < 2; ++c)
    relative(found(c * kPlane) - s * vortex(c, 0, 0),
             sip.at("uniform")[std::size_t(c)],
             is.sip);
  at_probes(sip.at("target_probes"), [&](Index a, const Json& p) {
    relative(found(a), p[2], is.sip);
    relative(found(kPlane + a), p[3], is.sip);
  });
  relative(0.5 * (x - found).squaredNorm(), sip.at("nn_loss"), is.sip);
}

TEST(MarkerFlowReference, Physics) {
  check_entries(kFluidId,
                {{"step", in_both(check_step<float>, check_step<double>)},
                 {"frequency_loss", check_loss},
                 {"vortex_moment", check_vortex},
                 {"scene", in_both(check_scene<float>, check_scene<double>)},
                 {"discretise", check_discretise}},
                {"mac_cormack_periodic", "stagger_project", "u_net", "adam"});
}

}  // namespace
}  // namespace physinv::test
