#include "problems/marker_flow/marker_flow.h"

#include "problems/fluid/noise.h"
#include "problems/fluid/run_tape.h"
#include "problems/marker_flow/periodic_flow.h"
#include "suite/core/check.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

using fluid::Block;
using fluid::RunTape;

template <class T>
struct Kernel {
  using P = fluid::Samples8<T>;
  static constexpr Index W = fluid::kWidth<T>;

  explicit Kernel(const MarkerFlowOptions& o)
      : options(o),
        flow(o.cells, o.end_time / double(o.steps) / (o.box / double(o.cells))),
        loss(o.cells, o.falloff, o.threshold),
        plane(flow.plane().size()),
        vortex(o.turning()),
        swirl(2 * o.cells * o.cells) {
    for (Index i = 0, a = 0; i < o.cells; ++i) {
      away.push_back(static_cast<T>(vortex.from_middle(i)));
      for (Index j = 0; j < o.cells; ++j, ++a)
        for (int c = 0; c < 2; ++c)
          swirl(c * o.cells * o.cells + a) = static_cast<T>(vortex(c, i, j));
    }
  }

  const MarkerFlowOptions options;
  const PeriodicFlow<P> flow;
  const FrequencyLoss loss;
  const Index plane;  ///< packs of a plane
  const Vortex vortex;
  Vector<T> swirl;      ///< W
  std::vector<T> away;  ///< r along an axis

  /// A step's part of the memory: u, v, m before it, s of them, two energies.
  Index state_packs() const { return 6 * plane + 2; }
  Index state_bytes() const { return 3 * flow.decisions(); }
  Index scratch_packs() const { return fluid::kScratchPlanes * plane; }

  MarkerStep<P> step(P* states, std::uint8_t* decisions, Index t) const {
    P* const p = states + t * state_packs();
    MarkerStep<P> s{p,
                    p + plane,
                    p + 2 * plane,
                    p + 3 * plane,
                    p + 4 * plane,
                    p + 5 * plane,
                    p + 6 * plane};
    if (decisions != nullptr) {
      s.u_held = decisions + t * state_bytes();
      s.v_held = s.u_held + flow.decisions();
      s.m_held = s.v_held + flow.decisions();
    }
    return s;
  }
  static MarkerState<P> fields(const MarkerStep<P>& s) {
    return {s.u, s.v, s.m};
  }

  /// Rows of a batch from `first` to a plane with its padding, and back.
  void load(const Block<T>& block, BatchIn<T> batch, Index first, P* f) const {
    Index row = first;
    flow.plane().for_points(
        [&](Index, Index, Index at) { f[at] = block.load(batch, row++); });
    wrap(flow.plane(), f);
  }
  void store(const Block<T>& block,
             const P* f,
             BatchOut<T>& batch,
             Index first) const {
    Index row = first;
    flow.plane().for_points(
        [&](Index, Index, Index at) { block.store(f[at], batch, row++); });
  }

  /// The first state.
  void begin(const Block<T>& block,
             BatchIn<T> x,
             BatchIn<T> given,
             const MarkerStep<P>& s,
             P* scratch) const {
    load(block, x, 0, s.u_back);
    load(block, x, options.cells * options.cells, s.v_back);
    load(block, given, 0, s.m);
    flow.to_faces(s.u_back, s.v_back, s.u, s.v, scratch);
  }

  /// Runs on from state 0: states[t] are those before step t, the last ones
  /// follow. All are in use at once with decisions, else two in turn. Calls
  /// seen(t, state) after step t.
  template <class F>
  void run(P* states, std::uint8_t* decisions, P* scratch, F&& seen) const {
    Index t = 0;
    fluid::for_steps(*this,
                     options.steps,
                     states,
                     decisions,
                     [&](const MarkerStep<P>& s, const MarkerStep<P>& next) {
                       flow.advance(s, fields(next), scratch);
                       seen(t++, next);
                     });
  }
  void run(P* states, std::uint8_t* decisions, P* scratch) const {
    run(states, decisions, scratch, [](Index, const MarkerStep<P>&) {});
  }

  /// From the last states of a kept run back to the unknowns; `bars` are six
  /// planes.
  void retreat(const Block<T>& block,
               BatchIn<T> y_bar,
               P* states,
               std::uint8_t* decisions,
               P* bars,
               P* scratch,
               BatchOut<T>& x_bar) const {
    MarkerState<P> bar{bars, bars + plane, bars + 2 * plane},
        out{bars + 3 * plane, bars + 4 * plane, bars + 5 * plane};
    std::fill_n(bars, 2 * plane, P{});
    load(block, y_bar, 0, bar.m);
    for (Index t = options.steps; t-- > 0;) {
      const auto now = fields(step(states, nullptr, t + 1));
      flow.retreat(step(states, decisions, t), now, bar, out, scratch);
      std::swap(bar, out);
    }
    flow.from_faces(bar.u, bar.v, out.u, out.v, scratch);
    store(block, out.u, x_bar, 0);
    store(block, out.v, x_bar, options.cells * options.cells);
  }

  // ---- the way back ---------------------------------------------------------

  struct Place {
    P x, y;  ///< from the middle
    friend Place operator-(const Place& a, const Place& b) {
      return {a.x - b.x, a.y - b.y};
    }
    Place operator*(T times) const { return {times * x, times * y}; }
  };
  static P cross(const Place& a, const Place& b) {
    return fma_lanes(a.x, b.y, -(a.y * b.x));
  }

  Place centre_of_mass(const P* m) const {
    const auto& g = flow.plane();
    P mass{};
    Place moment{};
    for (Index i = 0; i < g.rows; ++i) {
      P row{}, along{};
      for (Index j = 0; j < g.columns; ++j) {
        const P here = m[g.at(i, j)];
        row = row + here;
        along = fma_lanes(here, P{} + away[std::size_t(j)], along);
      }
      mass = mass + row, moment.y = moment.y + along;
      moment.x = fma_lanes(row, P{} + away[std::size_t(i)], moment.x);
    }
    const auto some = mass != P{};
    const P safe = select(some, mass, T(1) - P{});
    return {select(some, moment.x / safe, P{}),
            select(some, moment.y / safe, P{})};
  }

  /// Vortex::strength of centred velocities.
  P strength(const P* x, const P* y) const {
    const auto& g = flow.plane();
    P sum{};
    for (Index i = 0; i < g.rows; ++i) {
      P row{}, across{};
      for (Index j = 0; j < g.columns; ++j) {
        row = row + y[g.at(i, j)];
        across = fma_lanes(x[g.at(i, j)], P{} + away[std::size_t(j)], across);
      }
      sum = fma_lanes(row, P{} + away[std::size_t(i)], sum - across);
    }
    return sum *
           static_cast<T>(1 / (double(g.rows * g.columns) * vortex.moment));
  }

  /// `states` are two, `seen` steps + 1 places.
  void invert(const Block<T>& block,
              BatchIn<T> y,
              BatchIn<T> given,
              BatchIn<T> guess,
              P* states,
              Place* seen,
              P* scratch,
              BatchOut<T>& x) const {
    const Index steps = options.steps, cells = options.cells * options.cells;
    const auto first = step(states, nullptr, 0);
    begin(block, guess, given, first, scratch);
    const P held = strength(first.u_back, first.v_back);
    seen[0] = centre_of_mass(first.m);
    run(states, nullptr, scratch, [&](Index t, const MarkerStep<P>& s) {
      seen[t + 1] = centre_of_mass(s.m);
    });
    const auto duration = static_cast<T>(options.end_time);
    const Place uniform = seen[0] * (-1 / duration);

    const auto apart = [&](Index n, const P* m, T time) {
      const Place q = centre_of_mass(m);
      return cross(seen[n] - q, q - uniform * time);
    };
    MarkerStep<P> s = step(states, nullptr, steps % 2),
                  next = step(states, nullptr, (steps + 1) % 2);
    for (Index a = 0; a < plane; ++a) s.u[a] = -s.u[a], s.v[a] = -s.v[a];
    load(block, y, 0, s.m);
    P sum = apart(steps, s.m, duration);
    const T dt = options.timed_path ? duration / T(steps) : T(1);
    for (Index n = steps; n-- > 0;) {
      flow.advance(s, fields(next), scratch);
      std::swap(s, next);
      sum = sum + apart(n, s.m, T(n) * dt);
    }
    const P corrected =
        fma_lanes(P{} + static_cast<T>(options.correction / double(steps + 1)),
                  sum,
                  held);
    for (Index row = 0; row < 2 * cells; ++row)
      block.store(
          fma_lanes(
              corrected, P{} + swirl(row), row < cells ? uniform.x : uniform.y),
          x,
          row);
  }
};

template <class T>
class MarkerFlow final : public Problem<T>, public Vjp<T>, public Inverse<T> {
 public:
  explicit MarkerFlow(const MarkerFlowOptions& o) : options_(o) {
    check_numbers<T>({{"box", o.box},
                      {"end_time", o.end_time},
                      {"falloff", o.falloff},
                      {"threshold", o.threshold},
                      {"fill", o.fill[0]},
                      {"fill", o.fill[1]},
                      {"half", o.half},
                      {"vortex", o.vortex},
                      {"width", o.width},
                      {"moment", o.moment},
                      {"noise", o.noise},
                      {"correction", o.correction}});
    SUITE_CHECK(o.cells >= 4 && (o.cells & (o.cells - 1)) == 0,
                "cells must be a power of two, at least 4");
    SUITE_CHECK(o.box > 0 && o.end_time > 0 && o.steps > 0,
                "box, end time and number of steps must be positive");
    SUITE_CHECK(0 < o.fill[0] && o.fill[0] <= o.fill[1] && o.fill[1] <= 1,
                "fill must be a range within [0, 1]");
    SUITE_CHECK(o.half > 0 && o.width > 0 && o.moment > 0 && o.noise >= 0,
                "sizes of marker and vortex must be positive, noise must not "
                "be negative");
    kernel_ = std::make_unique<const Kernel<T>>(o);
  }

  Shape shape() const override {
    const Index plane = options_.cells * options_.cells;
    return {2 * plane, plane, plane};
  }
  Vector<double> start() const override {
    return Vector<double>::Zero(shape().unknowns);
  }

  void draw(Stream& stream, SampleOut& sample) const override {
    const auto& o = options_;
    const Index cells = o.cells * o.cells;
    const Vortex turning = o.turning();
    const Index cut = fluid::noise_cut(o.box);
    const auto anywhere = [&] {
      return stream.uniform(o.box / 4, o.box * 3 / 4);
    };
    do {  // a square without any marker is possible, and of no use
      const MarkerPatch patch{{anywhere(), anywhere()},
                              o.half,
                              stream.uniform(o.fill[0], o.fill[1])};
      const Vector<double> noise =
          fluid::smooth_noise({.cells = o.cells, .cut = cut}, stream);
      sample.given = marker(o.grid(), patch, noise);
    } while (sample.given.isZero(0));
    const MarkerPoint mass = centre_of_mass(o.grid(), sample.given);
    const double s = stream.uniform(-o.vortex, o.vortex);
    const Vector<double> small = fluid::smooth_noise(
        {.cells = o.cells, .components = 2, .cut = cut, .deviation = o.noise},
        stream);
    for (int k = 0; k < 2; ++k) {
      const double uniform =
          (0.5 * o.box - (k == 0 ? mass.x : mass.y)) / o.end_time;
      for (Index i = 0; i < o.cells; ++i)
        for (Index j = 0; j < o.cells; ++j) {
          const Index row = k * cells + i * o.cells + j;
          sample.x(row) = std::fma(s, turning(k, i, j), uniform) + small(row);
        }
    }
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    const auto &x = at.x, &given = at.given;
    const Kernel<T>& k = *kernel_;
    using P = typename Kernel<T>::P;
    for_registers(work, x.cols(), k.W, [&](SampleBlock part, Workspace& mine) {
      const Block<T> block(part, x, given);
      const Index states = 2 * k.state_packs();
      auto memory = mine.take<T>(k.W, states + k.scratch_packs());
      P* const p = reinterpret_cast<P*>(memory.data());
      k.begin(block, x, given, k.step(p, nullptr, 0), p + states);
      k.run(p, nullptr, p + states);
      k.store(block, k.step(p, nullptr, options_.steps % 2).m, y, 0);
    });
  }
  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override {
    for (Index i = 0; i < y.cols(); ++i)
      loss(i) = kernel_->loss(
          (y.col(i) - target.col(i)).template cast<double>(), nullptr);
  }
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override {
    Vector<double> bar(y.rows());
    for (Index i = 0; i < y.cols(); ++i) {
      kernel_->loss((y.col(i) - target.col(i)).template cast<double>(),
                    bar.data());
      y_bar.col(i) = bar.template cast<T>();
    }
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto &x = at.x, &given = at.given;
    const Kernel<T>& k = *kernel_;
    using P = typename Kernel<T>::P;
    auto kept = RunTape<T>::write(tape, x, given, {k, options_.steps});
    for_registers(
        tape.threads(), x.cols(), k.W, [&](SampleBlock part, int thread) {
          const Block<T> block(part, x, given);
          P *const s = kept.scratch(thread), *const p = kept.states(block);
          k.begin(block, x, given, k.step(p, nullptr, 0), s);
          k.run(p, kept.decisions(block), s);
          k.store(block, k.step(p, nullptr, options_.steps).m, y, 0);
        });
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    const Kernel<T>& k = *kernel_;
    using P = typename Kernel<T>::P;
    RunTape<T> kept(tape);
    const Index samples = kept.x.cols();
    for_registers(work, samples, k.W, [&](SampleBlock part, Workspace& mine) {
      const Block<T> block(part, kept.x, kept.given);
      const Index bars = 6 * k.plane;
      auto memory = mine.take<T>(k.W, bars + k.scratch_packs());
      P* const m = reinterpret_cast<P*>(memory.data());
      k.retreat(block,
                y_bar,
                kept.states(block),
                kept.decisions(block),
                m,
                m + bars,
                x_bar);
    });
  }
  void invert(Point<T> near,
              BatchIn<T> y,
              BatchOut<T> x,
              Workspace& work) const override {
    const auto &x_guess = near.x, &given = near.given;
    const Kernel<T>& k = *kernel_;
    using P = typename Kernel<T>::P;
    for_registers(work, x.cols(), k.W, [&](SampleBlock part, Workspace& mine) {
      const Block<T> block(part, x_guess, given, y);
      const Index states = 2 * k.state_packs(), places = 2 * options_.steps + 2;
      auto memory = mine.take<T>(k.W, states + places + k.scratch_packs());
      P* const p = reinterpret_cast<P*>(memory.data());
      k.invert(block,
               y,
               given,
               x_guess,
               p,
               reinterpret_cast<typename Kernel<T>::Place*>(p + states),
               p + states + places,
               x);
    });
  }

  /// A register of samples: the states of more only fill memory.
  Index gradient_block() const override { return fluid::kWidth<T>; }
  /// Counted from the formulas: 48 per cell for each of three advections, and
  /// some 70 for the two transforms of the projection and the rest.
  double operations() const override {
    return double(options_.steps) * double(options_.cells * options_.cells) *
           220;
  }

  const MarkerFlowOptions& options() const { return options_; }

 private:
  MarkerFlowOptions options_;
  std::unique_ptr<const Kernel<T>> kernel_;
};

}  // namespace

const MarkerFlowOptions* marker_flow_options(const Problem<double>& problem) {
  const auto* flow = dynamic_cast<const MarkerFlow<double>*>(&problem);
  return flow != nullptr ? &flow->options() : nullptr;
}

ProblemRecipe problems::marker_flow(const MarkerFlowOptions& options) {
  return problem<MarkerFlow>(
      "marker_flow",
      options,
      {.unknowns = {"velocity at the start(component, i, j)"},
       .observations = {"density at the end(i, j)"},
       .given = {"density at the start(i, j)"}});
}

}  // namespace physinv
