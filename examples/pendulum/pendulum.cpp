#include "pendulum.h"

#include <cmath>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"

namespace pendulum {
namespace {

constexpr Index kSights = 8;

/// What a pendulum is made of.
template <class T>
struct Body {
  T h, w2, damping;
};

template <class T>
struct State {
  T angle, speed;
};

/// The one place where a step is made, so that `forward` and `linearize` agree
/// to the last bit. Products and sums fuse where it says so.
template <class T>
State<T> step(const Body<T>& b, State<T> s) {
  const T force = std::fma(b.damping, s.speed, b.w2 * math::sin(s.angle));
  s.speed = std::fma(-b.h, force, s.speed);
  s.angle = std::fma(b.h, s.speed, s.angle);
  return s;
}

/// Calls each(k, state) before step k; the angles go to y.
template <class T, class F>
void swing(
    const Body<T>& b, State<T> s, Index substeps, VectorOut<T> y, F&& each) {
  for (Index k = 0; k < kSights * substeps; ++k) {
    each(k, s);
    s = step(b, s);
    if ((k + 1) % substeps == 0) y(k / substeps) = s.angle;
  }
}

enum Slot : std::size_t { kBodies, kStates };

template <class T>
class Pendulum final : public Problem<T>, public Vjp<T> {
 public:
  explicit Pendulum(const PendulumOptions& options)
      : substeps_(options.substeps),
        h_(static_cast<T>(options.interval /
                          static_cast<double>(options.substeps))) {
    check_numbers<T>({{"interval", options.interval}});
    SUITE_CHECK(options.interval > 0, "interval must be positive");
    SUITE_CHECK(options.substeps > 0, "substeps must be positive");
  }

  Shape shape() const override { return {3, kSights, 1}; }
  Vector<double> start() const override { return Eigen::Vector3d(0.5, 0, 0.1); }
  /// A sine counts as 20.
  double operations() const override {
    return 27.0 * static_cast<double>(kSights * substeps_);
  }

  /// Observed is y = F(x | given) of what is drawn here.
  void draw(Stream& stream, SampleOut& sample) const override {
    sample.x(0) = stream.uniform(-2, 2);
    sample.x(1) = stream.uniform(-1, 1);
    sample.x(2) = stream.uniform(0, 0.5);
    sample.given(0) = stream.uniform(0.8, 1.2);
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    for (Index i = 0; i < y.cols(); ++i)
      swing<T>(body(at, i),
               {at.x(0, i), at.x(1, i)},
               substeps_,
               y.col(i),
               [](Index, State<T>) {});
  }

  /// Keeps w^2, the damping and every angle and speed before its step. The tape
  /// keeps its memory from call to call: nothing allocates after the first call
  /// of a size.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    auto bodies = tape.slot<T>(kBodies, 2, y.cols());
    auto states = tape.slot<T>(kStates, 2 * kSights * substeps_, y.cols());
    for (Index i = 0; i < y.cols(); ++i) {
      const Body<T> b = body(at, i);
      bodies(0, i) = b.w2, bodies(1, i) = b.damping;
      swing<T>(b,
               {at.x(0, i), at.x(1, i)},
               substeps_,
               y.col(i),
               [&](Index k, State<T> s) {
                 states(2 * k, i) = s.angle, states(2 * k + 1, i) = s.speed;
               });
    }
  }

  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    const auto bodies = tape.view<T>(kBodies), states = tape.view<T>(kStates);
    for (Index i = 0; i < states.cols(); ++i) {
      T angle_bar = 0, speed_bar = 0, damping_bar = 0;
      for (Index k = kSights * substeps_ - 1; k >= 0; --k) {
        if ((k + 1) % substeps_ == 0) angle_bar += y_bar(k / substeps_, i);
        speed_bar = std::fma(h_, angle_bar, speed_bar);
        const T force_bar = -h_ * speed_bar;
        damping_bar = std::fma(states(2 * k + 1, i), force_bar, damping_bar);
        speed_bar = std::fma(bodies(1, i), force_bar, speed_bar);
        angle_bar = std::fma(
            bodies(0, i) * math::cos(states(2 * k, i)), force_bar, angle_bar);
      }
      x_bar.col(i) << angle_bar, speed_bar, damping_bar;
    }
  }

 private:
  Body<T> body(const Point<T>& at, Index i) const {
    return {h_, at.given(0, i) * at.given(0, i), at.x(2, i)};
  }

  Index substeps_;
  T h_;
};

}  // namespace

ProblemRecipe pendulum(const PendulumOptions& options) {
  return problem<Pendulum>(
      "pendulum",
      options,
      {.unknowns = {"angle, angular velocity, damping", "rad, rad/s, 1/s"},
       .observations = {"angle(sight)", "rad"},
       .given = {"frequency", "rad/s"}});
}

}  // namespace pendulum
