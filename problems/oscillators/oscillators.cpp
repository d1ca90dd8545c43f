#include "problems/oscillators/oscillators.h"

#include <algorithm>

#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/core/simd/samples.h"
#include "suite/core/threads.h"

namespace physinv {
namespace {

constexpr int kGroups = 2;  ///< registers of samples that run side by side
constexpr Index kStages = 4;
constexpr Index kChunk = 4;  ///< steps whose controls are loaded together

template <class T>
using Group = Wide<T, kGroups>;

template <class T>
constexpr Index group_count(Index samples) {
  return (samples + Group<T>::kCount - 1) / Group<T>::kCount;
}

template <class T>
struct Constants {
  explicit Constants(const OscillatorsOptions& o)
      : steps(o.steps),
        g(T(o.coupling)),
        c(T(o.control)),
        dt(T(o.dt)),
        half(T(o.dt / 2)),
        sixth(T(o.dt / 6)),
        third(T(o.dt / 3)) {}
  Index steps;
  T g, c, dt, half, sixth, third;
};

/// State, tangent or cotangent: components in the order x1, x2, p1, p2.
template <class V>
struct Four {
  V x1, x2, p1, p2;
};

template <class S, class V>
PHYSINV_LANES Four<V> add(const Four<V>& a, S s, const Four<V>& b) {
  return {fma_lanes(s, b.x1, a.x1),
          fma_lanes(s, b.x2, a.x2),
          fma_lanes(s, b.p1, a.p1),
          fma_lanes(s, b.p2, a.p2)};
}

template <class V>
PHYSINV_LANES Four<V> operator+(const Four<V>& a, const Four<V>& b) {
  return {a.x1 + b.x1, a.x2 + b.x2, a.p1 + b.p1, a.p2 + b.p2};
}

template <class S, class V>
PHYSINV_LANES Four<V> scale(S s, const Four<V>& a) {
  return {s * a.x1, s * a.x2, s * a.p1, s * a.p2};
}

/// Time derivative at s; w = g (x2 - x1)^2 for the reverse pass.
template <class T, class V>
PHYSINV_LANES Four<V> rate(const Constants<T>& k,
                           const Four<V>& s,
                           const V& force,
                           V& w) {
  const V d = s.x2 - s.x1;
  w = k.g * (d * d);
  return {s.p1, s.p2, fma_lanes(w, d, -s.x1), fma_lanes(-w, d, force - s.x2)};
}

template <class T, class V>
PHYSINV_LANES Four<V> runge_kutta(const Constants<T>& k,
                                  const Four<V>& s,
                                  const V& u,
                                  V (&w)[kStages]) {
  const V force = k.c * u;
  const Four<V> k1 = rate(k, s, force, w[0]);
  const Four<V> k2 = rate(k, add(s, k.half, k1), force, w[1]);
  const Four<V> k3 = rate(k, add(s, k.half, k2), force, w[2]);
  const Four<V> k4 = rate(k, add(s, k.dt, k3), force, w[3]);
  const Four<V> end = add(add(s, k.sixth, k1), k.sixth, k4);
  return add(add(end, k.third, k2), k.third, k3);
}

/// All steps of one group; `kept` (or null) takes w of every stage.
template <class T>
void integrate(const Constants<T>& constants,
               BatchIn<T> x,
               Index first,
               Four<Group<T>>& state,
               Group<T>* kept) {
  const Constants<T> k = constants;  // stores through `kept` cannot touch it
  Four<Group<T>> s = state;
  for (Index n = 0; n < k.steps; n += kChunk) {
    const Index count = std::min(kChunk, k.steps - n);
    Group<T> u[kChunk], w[kStages];
    load_rows(x, n, count, first, u);
    for (Index i = 0; i < count; ++i) {
      s = runge_kutta(k, s, u[i], w);
      if (kept == nullptr) continue;
      for (Index stage = 0; stage < kStages; ++stage) *kept++ = w[stage];
    }
  }
  state = s;
}

/// Cotangent of the positions of one stage, from that of its rate; those of the
/// momenta are k_bar.x1 and k_bar.x2 as they are: a copy would go through
/// memory.
template <class V>
struct Positions {
  V x1, x2;
};

template <class T, class E, class V>
PHYSINV_LANES Positions<V> rate_transposed(const E& w, const Four<V>& k_bar) {
  const V away = k_bar.p1 - k_bar.p2;
  return {fma_lanes(-w, away, -k_bar.p1), fma_lanes(w, away, -k_bar.p2)};
}

/// a + s times the cotangent of that stage.
template <class S, class V>
PHYSINV_LANES Four<V> add(const Four<V>& a,
                          S s,
                          const Positions<V>& x,
                          const Four<V>& k_bar) {
  return {fma_lanes(s, x.x1, a.x1),
          fma_lanes(s, x.x2, a.x2),
          fma_lanes(s, k_bar.x1, a.p1),
          fma_lanes(s, k_bar.x2, a.p2)};
}

template <class V>
PHYSINV_LANES V tripled(const V& w) {
  return LaneScalar<V>(3) * w;
}

/// One step backwards: the cotangent of its start replaces that of its end;
/// returns the cotangent of the control. V may hold several rows of one
/// group's samples, whose w are then shared.
template <class T, class V, class W>
PHYSINV_LANES V step_transposed(const Constants<T>& k,
                                Four<V>& bar,
                                const W& w) {
  const Four<V> third = scale(k.third, bar), k4 = scale(k.sixth, bar);
  const Positions<V> s4 = rate_transposed<T>(w(3), k4);
  const Four<V> k3 = add(third, k.dt, s4, k4);
  const Positions<V> s3 = rate_transposed<T>(w(2), k3);
  const Four<V> k2 = add(third, k.half, s3, k3);
  const Positions<V> s2 = rate_transposed<T>(w(1), k2);
  const Four<V> k1 = add(k4, k.half, s2, k2);
  const Positions<V> s1 = rate_transposed<T>(w(0), k1);
  bar.x1 = (((bar.x1 + s4.x1) + s3.x1) + s2.x1) + s1.x1;
  bar.x2 = (((bar.x2 + s4.x2) + s3.x2) + s2.x2) + s1.x2;
  bar.p1 = (((bar.p1 + k4.x1) + k3.x1) + k2.x1) + k1.x1;
  bar.p2 = (((bar.p2 + k4.x2) + k3.x2) + k2.x2) + k1.x2;
  return k.c * ((k1.p2 + k4.p2) + (k2.p2 + k3.p2));
}

template <class T>
Four<Group<T>> load_state(BatchIn<T> batch, Index first) {
  Group<T> s[4];
  load_rows(batch, 0, 4, first, s);
  return {s[0], s[1], s[2], s[3]};
}

template <class T>
void store_state(const Four<Group<T>>& s, BatchOut<T>& batch, Index first) {
  const Group<T> rows[4] = {s.x1, s.x2, s.p1, s.p2};
  store_rows(rows, batch, 0, 4, first);
}

/// Gradients of one group from the cotangent of its final state.
template <class T>
void pull_group(const Constants<T>& k,
                const Group<T>* kept,
                Four<Group<T>> bar,
                BatchOut<T>& x_bar,
                Index first) {
  for (Index end = k.steps; end > 0;) {
    const Index begin = (end - 1) / kChunk * kChunk;
    Group<T> u_bar[kChunk];
    for (Index n = end; n-- > begin;) {
      const Group<T>* w = kept + n * kStages;
      u_bar[n - begin] =
          step_transposed(k, bar, [&](int i) { return tripled(w[i]); });
    }
    store_rows(u_bar, x_bar, begin, end - begin, first);
    end = begin;
  }
}

/// The rows of the identity.
template <class T>
Four<Wide<T, 4>> unit_rows() {
  const auto unit = [](int component) {
    return Wide<T, 4>::make(
        [&](int row) { return Pack<T>{} + T(row == component); });
  };
  return {unit(0), unit(1), unit(2), unit(3)};
}

/// Jacobians of register g of one group; returns d state_end / d state_start.
template <class T>
Four<Wide<T, 4>> differentiate(const Constants<T>& k,
                               const Group<T>* kept,
                               int g,
                               BatchOut<T>& j,
                               Index first) {
  Four<Wide<T, 4>> bar = unit_rows<T>();
  for (Index n = k.steps; n-- > 0;) {
    const Group<T>* w = kept + n * kStages;
    const Wide<T, 4> column =
        step_transposed(k, bar, [&](int i) { return tripled(w[i].r[g]); });
    store_rows(column.r, 1, j, 4 * n, 4, first);
  }
  return bar;
}

enum Slot : std::size_t { kKept };

}  // namespace

template <class T>
OscillatorsStep oscillators_step(const std::array<double, 4>& state,
                                 double u,
                                 const OscillatorsOptions& options) {
  OscillatorsOptions one = options;
  one.steps = 1;
  const Constants<T> k(one);
  Batch<T> x(1, 1), s(4, 1), j(4, 1);
  x(0, 0) = T(u);
  for (Index i = 0; i < 4; ++i) s(i, 0) = T(state[std::size_t(i)]);
  Group<T> kept[kStages];
  auto at = load_state<T>(s, 0);
  integrate<T>(k, x, 0, at, kept);
  BatchOut<T> columns(j), end(s);
  const auto rows = differentiate(k, kept, 0, columns, 0);
  store_state<T>(at, end, 0);
  OscillatorsStep out;
  for (std::size_t i = 0; i < 4; ++i) {
    out.y[i] = double(s(Index(i), 0));
    out.b[i] = double(j(Index(i), 0));
    out.a[i] = {double(rows.x1.r[i][0]),
                double(rows.x2.r[i][0]),
                double(rows.p1.r[i][0]),
                double(rows.p2.r[i][0])};
  }
  return out;
}

template decltype(oscillators_step<float>) oscillators_step<float>;
template decltype(oscillators_step<double>) oscillators_step<double>;

namespace {

template <class T>
class Oscillators final : public Problem<T>, public Vjp<T>, public Jacobian<T> {
 public:
  explicit Oscillators(const OscillatorsOptions& options) : options_(options) {
    check_numbers<T>({{"dt", options.dt},
                      {"coupling", options.coupling},
                      {"control", options.control},
                      {"deviation", options.deviation}});
    SUITE_CHECK(options.steps > 0 && options.dt > 0,
                "steps and dt must be positive");
    SUITE_CHECK(options.deviation >= 0, "deviation must not be negative");
  }

  Shape shape() const override { return {options_.steps, 4, 4}; }
  /// No control.
  Vector<double> start() const override {
    return Vector<double>::Zero(options_.steps);
  }

  /// States uniform in [0, 1)^4, observed where they started; of labelled
  /// samples under random controls, and where these lead.
  void draw(Stream& stream, SampleOut& sample) const override {
    for (Index k = 0; k < 4; ++k) sample.given(k) = stream.uniform();
    sample.y = sample.given;
    if (!sample.labelled) return;
    Stream controls = sample.rng.child("control").stream();
    controls.normals(sample.x.data(), options_.steps);
    sample.x *= options_.deviation;
  }
  Drawn drawn() const override { return Drawn::observations; }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    const auto &x = at.x, &given = at.given;
    const Index samples = x.cols();
    const Constants<T> k(options_);
    for_blocks(work.threads(), group_count<T>(samples), [&](Index b, int) {
      const Index first = b * Group<T>::kCount;
      auto s = load_state<T>(given, first);
      integrate<T>(k, x, first, s, nullptr);
      store_state<T>(s, y, first);
    });
  }
  /// Keeps four numbers per step and sample.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto &x = at.x, &given = at.given;
    const Index groups = group_count<T>(x.cols());
    const Constants<T> k(options_);
    auto kept = tape.slot<T>(
        kKept, options_.steps * kStages * Group<T>::kCount, groups);
    for_blocks(tape.threads(), groups, [&](Index b, int) {
      const Index first = b * Group<T>::kCount;
      auto s = load_state<T>(given, first);
      integrate<T>(
          k, x, first, s, reinterpret_cast<Group<T>*>(kept.col(b).data()));
      store_state<T>(s, y, first);
    });
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    const auto kept = tape.view<T>(kKept);
    const Constants<T> k(options_);
    for_blocks(work.threads(), kept.cols(), [&](Index b, int) {
      const Index first = b * Group<T>::kCount;
      pull_group<T>(k,
                    reinterpret_cast<const Group<T>*>(kept.col(b).data()),
                    load_state<T>(y_bar, first),
                    x_bar,
                    first);
    });
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    const auto &x = at.x, &given = at.given;
    const Index samples = x.cols(), steps = options_.steps;
    const Constants<T> k(options_);
    Threads* threads = work.threads();
    if (threads != nullptr) work.of_thread(0);  // makes them all
    for_blocks(threads, group_count<T>(samples), [&](Index b, int thread) {
      Workspace& own = threads != nullptr ? work.of_thread(thread) : work;
      const Workspace::Scope scope(own);
      auto* kept = reinterpret_cast<Group<T>*>(
          own.take<T>(steps * kStages * Group<T>::kCount, 1).data());
      const Index first = b * Group<T>::kCount;
      auto s = load_state<T>(given, first);
      integrate<T>(k, x, first, s, kept);
      for (int g = 0; g < kGroups && first + g * kLanes<T> < samples; ++g)
        differentiate(k, kept, g, j, first + g * kLanes<T>);
    });
  }

  /// |y - target|^2
  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override {
    Problem<T>::loss(y, target, loss);
    loss *= 2;
  }
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override {
    for_numbers<T>(y, target, y_bar, [](T a, T b) { return T(2) * (a - b); });
  }

  double operations() const override {
    return 80.0 * static_cast<double>(options_.steps);
  }

 private:
  OscillatorsOptions options_;
};

}  // namespace

ProblemRecipe problems::oscillators(const OscillatorsOptions& options) {
  return problem<Oscillators>("oscillators",
                              options,
                              {.unknowns = {"u(step)"},
                               .observations = {"x1, x2, p1, p2"},
                               .given = {"x1, x2, p1, p2"}});
}

}  // namespace physinv
