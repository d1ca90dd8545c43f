#include "suite/cases/numerics/transport/transport.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "problems/fluid/mac_cormack.h"
#include "problems/marker_flow/marker_flow.h"
#include "problems/marker_flow/periodic_flow.h"
#include "suite/core/any_problem.h"
#include "suite/core/math.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv {
namespace {

constexpr Index kSamples = 4;

template <class T>
using Field = std::vector<fluid::Samples8<T>>;

// ---- energy ---------------------------------------------------------------

constexpr Index kSide = 32, kSteps = 1000, kEvery = 10;
constexpr Index kPoints = kSteps / kEvery + 1;

struct Drift {
  Batch<double> energy, unscaled, divergence;
};

template <class P>
double divergence(const fluid::Plane& g, const P* u, const P* v, int lane) {
  double most = 0, fastest = 0;
  g.for_points([&](Index, Index, Index at) {
    const P out = (u[at + g.stride] - u[at]) + (v[at + 1] - v[at]);
    most = std::max(most, std::abs(double(out[lane])));
    fastest = std::max(
        fastest,
        std::max(std::abs(double(u[at][lane])), std::abs(double(v[at][lane]))));
  });
  return fastest > 0 ? most / fastest : most;
}

template <class T>
Drift drift(const MarkerFlowOptions& o, const Batch<double>& x) {
  using P = fluid::Samples8<T>;
  const PeriodicFlow<P> flow(
      o.cells, o.end_time / double(o.steps) / (o.box / double(o.cells)));
  const fluid::Plane& g = flow.plane();
  const auto plane = static_cast<std::size_t>(g.size() + g.stride);
  std::vector<Field<T>> fields(9, Field<T>(plane));
  Field<T> scratch(fluid::kScratchPlanes * plane);
  const auto load = [&](Index row, Field<T>& f) {
    g.for_points([&](Index, Index, Index at) {
      for (int k = 0; k < fluid::kWidth<T>; ++k)
        f[std::size_t(at)][k] = static_cast<T>(x(row, k % kSamples));
      ++row;
    });
    wrap(g, f.data());
  };
  load(0, fields[6]), load(o.cells * o.cells, fields[7]);
  P energy[2];
  MarkerStep<P> now{.u = fields[0].data(),
                    .v = fields[1].data(),
                    .m = fields[2].data(),
                    .u_back = fields[6].data(),
                    .v_back = fields[7].data(),
                    .m_back = fields[8].data(),
                    .energy = energy};
  MarkerState<P> next{fields[3].data(), fields[4].data(), fields[5].data()};
  flow.to_faces(now.u_back, now.v_back, now.u, now.v, scratch.data());
  const P start = flow.energy(now.u, now.v);
  double left[kSamples] = {1, 1, 1, 1};
  Drift out{Batch<double>(kSamples, kPoints),
            Batch<double>(kSamples, kPoints),
            Batch<double>(kSamples, kPoints)};
  for (Index t = 0; t <= kSteps; ++t) {
    if (t % kEvery == 0) {
      const P is = flow.energy(now.u, now.v);
      for (int k = 0; k < kSamples; ++k) {
        const double whole = start[k];
        out.energy(k, t / kEvery) =
            number_or_none(std::abs(double(is[k]) - whole) / whole);
        out.unscaled(k, t / kEvery) = number_or_none(left[k]);
        out.divergence(k, t / kEvery) =
            number_or_none(divergence(g, now.u, now.v, k));
      }
    }
    flow.advance(now, next, scratch.data());
    for (int k = 0; k < kSamples; ++k)
      left[k] *= double(energy[1][k]) / double(energy[0][k]);
    std::swap(now.u, next.u), std::swap(now.v, next.v);
    std::swap(now.m, next.m);
  }
  return out;
}

class EnergyDrift final : public Diagnostic {
 public:
  std::string name() const override { return "energy"; }
  double operations(const CaseSize&) const override {
    return 2 * kSamples * kSteps * 220.0 * kSide * kSide;
  }

 protected:
  std::string kind() const override { return "energy_drift"; }
  std::vector<ProblemRecipe> problems() const override {
    return {problems::marker_flow(flow())};
  }
  Options settings() const override {
    return {{"problems", fingerprint(problems())}, {"steps", text_of(kSteps)}};
  }
  void diagnose(StageRun& run, Outcome& out) const override {
    run.probe.begin();
    const AnyProblem<double> problem(problems::marker_flow(flow()));
    const Batch<double> x =
        problem.sample(0, kSamples, run.batches.child("energy")).x;
    Drift exact = drift<double>(flow(), x), rough = drift<float>(flow(), x);
    auto& step = out.arrays["step"] = Batch<double>(1, kPoints);
    for (Index k = 0; k < kPoints; ++k) step(0, k) = double(k * kEvery);
    out.arrays["energy"] = std::move(exact.energy);
    out.arrays["energy_single"] = std::move(rough.energy);
    out.arrays["unscaled"] = std::move(exact.unscaled);
    out.arrays["divergence"] = std::move(exact.divergence);
  }

 private:
  static MarkerFlowOptions flow() { return {.cells = kSide}; }
};

// ---- order ----------------------------------------------------------------

constexpr Index kGrids[] = {16, 32, 64, 128};
constexpr double kTurn = 2 * std::numbers::pi, kEnd = 0.5, kCells = 0.5;
constexpr double kX = 0.7, kY = 0.4;  ///< the constant velocity

double wave(double x, double y) {
  return math::sin(kTurn * x) + math::cos(kTurn * (x + y));
}
double shear(double y) { return math::sin(kTurn * y); }

template <class P>
struct GivenVelocity {
  const P *x, *y;
  fluid::Velocity<P> operator()(Index at) const { return {x[at], y[at]}; }
};

/// Lane 0 goes with the constant velocity, lane 1 with the shear.
class Carried {
 public:
  explicit Carried(Index n)
      : n_(n),
        g_{n, n},
        scheme_(g_, kCells),
        f_(plane()),
        s_(plane()),
        next_(plane()),
        vx_(plane()),
        vy_(plane()),
        scratch_(fluid::kScratchPlanes * plane()),
        held_(static_cast<std::size_t>(scheme_.decisions())) {
    each([&](double x, double y, std::size_t at) {
      f_[at] = P{} + wave(x, y);
      vx_[at][0] = kX, vy_[at][0] = kY, vx_[at][1] = shear(y);
    });
  }

  double step() const { return kCells / double(n_); }
  void advance() {
    wrap(g_, f_.data());
    scheme_.advect(f_.data(),
                   GivenVelocity<P>{vx_.data(), vy_.data()},
                   s_.data(),
                   next_.data(),
                   held_.data(),
                   scratch_.data());
    std::swap(f_, next_);
    time_ += step();
  }
  double time() const { return time_; }

  double error(int lane) const {
    double sum = 0;
    each([&](double x, double y, std::size_t at) {
      const double off = f_[at][lane] - exact(lane, x, y);
      sum = std::fma(off, off, sum);
    });
    return std::sqrt(sum / double(n_ * n_));
  }
  /// Largest of lane 0 where the last step was free of the limiter.
  double free_error() const {
    double most = 0;
    std::size_t point = 0;
    each([&](double x, double y, std::size_t at) {
      if (held_[W * point++] == fluid::kFree)
        most = std::max(most, std::abs(f_[at][0] - exact(0, x, y)));
    });
    return most;
  }

 private:
  using P = fluid::Samples8<double>;
  static constexpr auto W = std::size_t(fluid::kWidth<double>);

  std::size_t plane() const {
    return static_cast<std::size_t>(g_.size() + g_.stride);
  }
  double exact(int lane, double x, double y) const {
    return lane == 0 ? wave(x - kX * time_, y - kY * time_)
                     : wave(x - shear(y) * time_, y);
  }
  template <class F>
  void each(F&& f) const {
    g_.for_points([&](Index i, Index j, Index at) {
      f(double(i) / double(n_), double(j) / double(n_), std::size_t(at));
    });
  }

  Index n_;
  fluid::Plane g_;
  fluid::MacCormack<fluid::Edge::periodic, P> scheme_;
  Field<double> f_, s_, next_, vx_, vy_, scratch_;
  std::vector<std::uint8_t> held_;
  double time_ = 0;
};

class AdvectionOrder final : public Diagnostic {
 public:
  std::string name() const override { return "order"; }
  double operations(const CaseSize&) const override {
    double cells = 0;
    for (const Index n : kGrids) cells += double(n * n * n);
    return fluid::kWidth<double> * 48 * cells * kEnd / kCells;
  }

 protected:
  std::string kind() const override { return "advection_order"; }
  Options settings() const override { return {{"grids", text_of(kGrids)}}; }
  void diagnose(StageRun& run, Outcome& out) const override {
    run.probe.begin();
    const auto array = [&](ArrayKey name) -> Batch<double>& {
      return out.arrays[name] = Batch<double>(1, std::size(kGrids));
    };
    auto &cells = array("cells"), &constant = array("constant"),
         &sheared = array("shear"), &free = array("free");
    for (std::size_t k = 0; k < std::size(kGrids); ++k) {
      const auto at = static_cast<Index>(k);
      Carried carried(kGrids[k]);
      cells(0, at) = double(kGrids[k]);
      carried.advance();
      free(0, at) = carried.free_error();
      const Index steps = std::lround(kEnd / carried.step());
      for (Index t = 1; t < steps; ++t) carried.advance();
      constant(0, at) = carried.error(0), sheared(0, at) = carried.error(1);
    }
  }
};

}  // namespace

std::shared_ptr<const Stage> energy_drift() {
  return std::make_shared<EnergyDrift>();
}
std::shared_ptr<const Stage> advection_order() {
  return std::make_shared<AdvectionOrder>();
}

}  // namespace physinv
