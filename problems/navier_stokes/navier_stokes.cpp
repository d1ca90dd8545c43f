#include "problems/navier_stokes/navier_stokes.h"

#include <memory>
#include <mutex>

#include "problems/fluid/noise.h"
#include "problems/fluid/run_tape.h"
#include "problems/navier_stokes/blast.h"
#include "problems/navier_stokes/box_flow.h"
#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

using fluid::Block;
using fluid::RunTape;

template <class T>
struct Kernel {
  using P = fluid::Samples8<T>;
  static constexpr Index W = fluid::kWidth<T>;

  explicit Kernel(const NavierStokesOptions& o)
      : options(o),
        projection(fluid::BoxMasks(o.cells, o.obstacles)),
        faces(projection.faces()),
        plane(faces.cells.size()),
        blast(o.cells, o.box, o.height, o.width),
        flow(projection,
             o.end_time / double(o.steps) / (o.box / double(o.cells))) {}

  const NavierStokesOptions options;
  const fluid::BoxProjection<T> projection;
  const fluid::Staggering<fluid::Edge::zero> faces;
  const Index plane;  ///< packs of a plane
  const BlastShape<T> blast;
  const BoxFlow<P> flow;

  /// A step's part of the memory: u, v before it, s of both.
  Index state_packs() const { return 4 * plane; }
  Index state_bytes() const { return 2 * flow.decisions(); }
  Index scratch_packs() const { return fluid::kScratchPlanes * plane; }

  FlowStep<P> step(P* states, std::uint8_t* decisions, Index t) const {
    P* const p = states + t * state_packs();
    FlowStep<P> s{p, p + plane, p + 2 * plane, p + 3 * plane};
    if (decisions != nullptr) {
      s.u_held = decisions + t * state_bytes();
      s.v_held = s.u_held + flow.decisions();
    }
    return s;
  }

  /// t of each unknown, in addition to the blast itself.
  struct Unknowns : Blast<P> {
    P t[3];
  };
  Unknowns unknowns(const Block<T>& block, BatchIn<T> x) const {
    const T half = static_cast<T>(0.5 * options.box);
    const T speed = static_cast<T>(options.speed);
    const P centre = P{} + half;
    P t[3];
    for (Index k = 0; k < 3; ++k) {
      const P z = block.load(x, k);
      t[k] = k < options.bounded ? tanh_lanes(z) : z;
    }
    return {{fma_lanes(centre, t[0], centre),
             speed * t[1],
             fma_lanes(P{} + speed, t[2], P{} + speed)},
            {t[0], t[1], t[2]}};
  }
  /// Cotangents of the unknowns from those of the blast; also, as the map is
  /// one by one, how much of each unknown moves the blast.
  Blast<P> scaled(const Unknowns& b, const Blast<P>& bar) const {
    const T half = static_cast<T>(0.5 * options.box);
    const T speed = static_cast<T>(options.speed);
    const auto slope = [&](Index k, T scale) {
      const P t = b.t[k], one = T(1) - P{};
      return k < options.bounded ? scale * fma_lanes(-t, t, one) : P{} + scale;
    };
    return {slope(0, half) * bar.x0,
            slope(1, speed) * bar.vx,
            slope(2, speed) * bar.vy};
  }

  /// Centred velocities to the faces, planes of zeros.
  void to_faces(const Block<T>& block, BatchIn<T> centred, P* u, P* v) const {
    const Index n = options.cells;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        const Index row = i * n + j, at = faces.cells.at(i, j);
        const P x = T(0.5) * block.load(centred, row);
        const P y = T(0.5) * block.load(centred, n * n + row);
        if (i + 1 < n) u[at] = u[at] + x;
        if (i > 0) u[at - faces.cells.stride] += x;
        if (j + 1 < n) v[at] = v[at] + y;
        if (j > 0) v[at - 1] += y;
      }
  }

  /// f(row, a, b): what is observed is half the sum of the faces a and b.
  template <class F>
  void for_observed(P* u, P* v, F&& f) const {
    const Index n = options.cells, half = n / 2;
    for (Index i = 0; i < n; ++i)
      for (Index j = half; j < n; ++j) {
        const Index row = i * half + j - half, at = faces.cells.at(i, j);
        f(row, u[at - faces.cells.stride], u[at]);
        f(n * half + row, v[at - 1], v[at]);
      }
  }

  /// The first state, in planes of zeros.
  void begin(const Block<T>& block,
             BatchIn<T> given,
             const Blast<P>& b,
             const FlowStep<P>& s,
             P* scratch) const {
    to_faces(block, given, s.u, s.v);
    blast.add(b, s.u, s.v);
    projection.project(s.u, s.v, scratch);
  }

  /// Runs a block: states[t] are those before step t, the last ones follow.
  /// All planes are in use at once if `keep`, else those of two steps.
  void run(const Block<T>& block,
           BatchIn<T> x,
           BatchIn<T> given,
           P* states,
           std::uint8_t* decisions,
           P* scratch) const {
    const Index steps = options.steps;
    const Index kept = decisions != nullptr ? steps : 1;
    std::fill_n(states, (kept + 1) * state_packs(), P{});
    begin(block, given, unknowns(block, x), step(states, nullptr, 0), scratch);
    fluid::for_steps(*this,
                     steps,
                     states,
                     decisions,
                     [&](const FlowStep<P>& s, const FlowStep<P>& next) {
                       flow.advance(s, next.u, next.v, scratch);
                     });
  }

  void observe(const Block<T>& block,
               P* states,
               Index t,
               BatchOut<T>& y) const {
    const auto s = step(states, nullptr, t);
    for_observed(s.u, s.v, [&](Index row, P a, P b) {
      block.store(T(0.5) * (a + b), y, row);
    });
  }

  /// Runs a block and, at the same time, its three tangents (12 planes).
  void push(const Block<T>& block,
            BatchIn<T> x,
            BatchIn<T> given,
            P* states,
            std::uint8_t* decisions,
            P* tangents,
            P* scratch,
            BatchOut<T>& j) const {
    const Index steps = options.steps;
    const Unknowns b = unknowns(block, x);
    std::fill_n(states, 2 * state_packs(), P{});
    std::fill_n(tangents, 12 * plane, P{});
    const auto u_dot = [=, this](Index k, Index t) {
      return tangents + (4 * k + t % 2 * 2) * plane;
    };
    begin(block, given, b, step(states, nullptr, 0), scratch);
    for (Index k = 0; k < 3; ++k) {
      P* const u = u_dot(k, 0);
      P one[3] = {};
      one[k] = T(1) - P{};
      blast.push(b, scaled(b, {one[0], one[1], one[2]}), u, u + plane);
      projection.project(u, u + plane, scratch);
    }
    for (Index t = 0; t < steps; ++t) {
      const auto s = step(states, decisions, t % 2);
      const auto next = step(states, nullptr, (t + 1) % 2);
      flow.advance(s, next.u, next.v, scratch);
      for (Index k = 0; k < 3; ++k) {
        P *const u = u_dot(k, t), *const to = u_dot(k, t + 1);
        flow.push(s, u, u + plane, to, to + plane, scratch);
      }
    }
    for (Index k = 0; k < 3; ++k) {
      P* const u = u_dot(k, steps);
      for_observed(u, u + plane, [&](Index row, P a, P c) {
        block.store(
            T(0.5) * (a + c), j, k * options.cells * options.cells + row);
      });
    }
  }

  /// From the last states of a kept run back to the unknowns. The planes of s
  /// of the last states are free.
  void retreat(const Block<T>& block,
               BatchIn<T> x,
               BatchIn<T> y_bar,
               P* states,
               std::uint8_t* decisions,
               P* bars,
               P* scratch,
               BatchOut<T>& x_bar) const {
    P *u = bars, *v = bars + plane, *u_out = bars + 2 * plane,
      *v_out = bars + 3 * plane;
    std::fill_n(bars, 2 * plane, P{});
    for_observed(u, v, [&](Index row, P& a, P& b) {
      const P half = T(0.5) * block.load(y_bar, row);
      a += half, b += half;
    });
    for (Index t = options.steps; t-- > 0;) {
      flow.retreat(step(states, decisions, t), u, v, u_out, v_out, scratch);
      std::swap(u, u_out), std::swap(v, v_out);
    }
    projection.pull(u, v, scratch);
    const Unknowns b = unknowns(block, x);
    const auto bar = scaled(b, blast.pull(b, u, v));
    block.store(bar.x0, x_bar, 0);
    block.store(bar.vx, x_bar, 1);
    block.store(bar.vy, x_bar, 2);
  }
};

/// The factor of the pressure, made when a flow is asked for.
template <class T>
struct Lazy {
  std::once_flag made;
  std::unique_ptr<const Kernel<T>> kernel;
};

template <class T>
class NavierStokes final : public Problem<T>,
                           public Vjp<T>,
                           public Jacobian<T> {
 public:
  explicit NavierStokes(const NavierStokesOptions& o) : options_(o) {
    check_numbers<T>({{"box", o.box},
                      {"end_time", o.end_time},
                      {"height", o.height},
                      {"width", o.width},
                      {"speed", o.speed},
                      {"noise", o.noise},
                      {"x0", o.x0[0]},
                      {"x0", o.x0[1]},
                      {"vx", o.vx[0]},
                      {"vx", o.vx[1]},
                      {"vy", o.vy[0]},
                      {"vy", o.vy[1]}});
    SUITE_CHECK(o.tape_budget >= 0, "tape_budget must not be negative");
    SUITE_CHECK(0 <= o.bounded && o.bounded <= 3,
                "bounded must be a number of unknowns, 0 to 3");
    SUITE_CHECK(o.bounded < 2 || (-1 <= o.vx[0] && o.vx[1] <= 1),
                "a bounded vx must lie in [-1, 1]");
    SUITE_CHECK(o.bounded < 3 || (0 <= o.vy[0] && o.vy[1] <= 2),
                "a bounded vy must lie in [0, 2]");
    SUITE_CHECK(o.vx[0] <= o.vx[1] && o.vy[0] <= o.vy[1],
                "vx and vy must be ranges");
    SUITE_CHECK(o.cells >= 4 && o.cells % 2 == 0,
                "cells must be an even number, at least 4");
    SUITE_CHECK(o.box > 0 && o.end_time > 0 && o.steps > 0,
                "box, end time and number of steps must be positive");
    SUITE_CHECK(o.width > 0 && o.speed > 0 && o.noise >= 0,
                "width and speed must be positive, noise must not be negative");
    SUITE_CHECK(0 < o.x0[0] && o.x0[0] <= o.x0[1] && o.x0[1] < 1,
                "the blast must start within the box");
  }

  Shape shape() const override {
    const Index cells = options_.cells * options_.cells;
    return {3, cells, 2 * cells};
  }
  Vector<double> start() const override { return Vector<double>::Zero(3); }

  void draw(Stream& stream, SampleOut& sample) const override {
    const auto& o = options_;
    auto& x = sample.x;
    x(0) = 2 * stream.uniform(o.x0[0], o.x0[1]) - 1;
    x(1) = stream.uniform(o.vx[0], o.vx[1]);
    x(2) = stream.uniform(o.vy[0], o.vy[1]) - 1;
    for (Index k = 0; k < o.bounded; ++k) x(k) = math::atanh(x(k));
    sample.given = fluid::smooth_noise({.cells = o.cells,
                                        .components = 2,
                                        .cut = fluid::noise_cut(o.box),
                                        .deviation = o.noise},
                                       stream);
  }
  /// The flow below.
  void hide(BatchOut<double> given) const override {
    const Index n = options_.cells;
    for (Index line = 0; line < 2 * n; ++line)
      given.middleRows(line * n, n / 2).setZero();
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    const auto &x = at.x, &given = at.given;
    const Kernel<T>& k = kernel();
    using P = typename Kernel<T>::P;
    for_registers(work, x.cols(), k.W, [&](SampleBlock part, Workspace& mine) {
      const Block<T> block(part, x, given);
      const Index states = 2 * k.state_packs();
      auto memory = mine.take<T>(k.W, states + k.scratch_packs());
      P* const p = reinterpret_cast<P*>(memory.data());
      k.run(block, x, given, p, nullptr, p + states);
      k.observe(block, p, options_.steps % 2, y);
    });
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto &x = at.x, &given = at.given;
    const Kernel<T>& k = kernel();
    using P = typename Kernel<T>::P;
    const fluid::RunSize size(k, options_.steps);
    const double blocks = double(registers(x.cols(), k.W));
    const bool all = blocks * size.bytes<T>() <= options_.tape_budget;
    auto kept = RunTape<T>::write(tape, x, given, size, all);
    for_registers(
        tape.threads(), x.cols(), k.W, [&](SampleBlock part, int thread) {
          const Block<T> block(part, x, given);
          P* const s = kept.scratch(thread);
          P* const p = all ? kept.states(block) : s + k.scratch_packs();
          k.run(block, x, given, p, kept.decisions(block), s);
          k.observe(block, p, all ? options_.steps : options_.steps % 2, y);
        });
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    const Kernel<T>& k = kernel();
    using P = typename Kernel<T>::P;
    RunTape<T> kept(tape);
    const auto &x = kept.x, &given = kept.given;
    for_registers(work, x.cols(), k.W, [&](SampleBlock part, Workspace& mine) {
      const Block<T> block(part, x, given);
      const Index bars = 4 * k.plane;
      auto memory = mine.take<T>(k.W, bars + k.scratch_packs());
      P* const m = reinterpret_cast<P*>(memory.data());
      P* p = kept.keeps() ? kept.states(block) : nullptr;
      std::uint8_t* decisions = kept.decisions(block);
      if (!kept.keeps()) {
        auto again = mine.take<T>(k.W, (options_.steps + 1) * k.state_packs());
        auto bytes = mine.take<std::uint8_t>(k.state_bytes(), options_.steps);
        p = reinterpret_cast<P*>(again.data()), decisions = bytes.data();
        k.run(block, x, given, p, decisions, m + bars);
      }
      k.retreat(block, x, y_bar, p, decisions, m, m + bars, x_bar);
    });
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    const auto &x = at.x, &given = at.given;
    const Kernel<T>& k = kernel();
    using P = typename Kernel<T>::P;
    for_registers(work, x.cols(), k.W, [&](SampleBlock part, Workspace& mine) {
      const Block<T> block(part, x, given);
      const Index states = 2 * k.state_packs(), tangents = 12 * k.plane;
      auto memory = mine.take<T>(k.W, states + tangents + k.scratch_packs());
      auto held = mine.take<std::uint8_t>(2 * k.state_bytes(), 1);
      P* const p = reinterpret_cast<P*>(memory.data());
      k.push(block,
             x,
             given,
             p,
             held.data(),
             p + states,
             p + states + tangents,
             j);
    });
  }

  /// A register of samples: the states of more only fill memory.
  Index gradient_block() const override { return fluid::kWidth<T>; }
  /// Counted from the formulas: 83 per face for the lookups and the limiter,
  /// and the projection's factor, some 30 per cell.
  double operations() const override {
    const double cells = double(options_.cells * options_.cells);
    return double(options_.steps) * cells * 166;
  }

 private:
  /// Factored when a flow is first simulated.
  const Kernel<T>& kernel() const {
    std::call_once(lazy_->made, [&] {
      lazy_->kernel = std::make_unique<const Kernel<T>>(options_);
    });
    return *lazy_->kernel;
  }

  NavierStokesOptions options_;
  std::unique_ptr<Lazy<T>> lazy_ = std::make_unique<Lazy<T>>();
};

}  // namespace

ProblemRecipe problems::navier_stokes(const NavierStokesOptions& options) {
  return problem<NavierStokes>(
      "navier_stokes",
      options,
      {.unknowns = {"z_0, z_1, z_2"},
       .observations = {"velocity at the end(component, i, j)"},
       .given = {"velocity at the start(component, i, j)"}});
}

}  // namespace physinv
