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

}  // namespace

template <class T>
Pendulum<T>::Pendulum(const Options& options) : options_(options) {
  check_numbers<T>({{"interval", options.interval}});
  SUITE_CHECK(options.interval > 0, "interval must be positive");
  SUITE_CHECK(options.substeps > 0, "substeps must be positive");
}

/// Sample i has a stream of its own, so that small sets are prefixes of large
/// ones. Data are drawn in double.
template <class T>
Samples<double> Pendulum<T>::sample(Index first,
                                    Index count,
                                    const Rng& rng) const {
  Samples<double> s{Batch<double>(3, count),
                    Batch<double>(kSights, count),
                    Batch<double>(1, count)};
  for (Index i = 0; i < count; ++i) {
    Stream stream = rng.child(static_cast<std::uint64_t>(first + i)).stream();
    s.x(0, i) = stream.uniform(-2, 2);
    s.x(1, i) = stream.uniform(-1, 1);
    s.x(2, i) = stream.uniform(0, 0.5);
    s.given(0, i) = stream.uniform(0.8, 1.2);
  }
  Workspace work;
  Pendulum<double>(options_).forward(s.x, s.given, s.y, work);
  return s;
}

template <class T>
void Pendulum<T>::forward(BatchIn<T> x,
                          BatchIn<T> given,
                          BatchOut<T> y,
                          Workspace&) const {
  check_size(x, 3, x.cols());
  check_size(y, kSights, x.cols());
  for (Index i = 0; i < x.cols(); ++i)
    swing<T>({step_size(), given(0, i) * given(0, i), x(2, i)},
             {x(0, i), x(1, i)},
             options_.substeps,
             y.col(i),
             [](Index, State<T>) {});
}

/// The tape keeps its memory from call to call: nothing allocates after the
/// first call of a size.
template <class T>
void Pendulum<T>::linearize(BatchIn<T> x,
                            BatchIn<T> given,
                            BatchOut<T> y,
                            Tape& tape) const {
  check_size(x, 3, x.cols());
  check_size(y, kSights, x.cols());
  auto bodies = tape.slot<T>(kBodies, 2, x.cols());
  auto states =
      tape.slot<T>(kStates, 2 * kSights * options_.substeps, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    bodies(0, i) = given(0, i) * given(0, i), bodies(1, i) = x(2, i);
    swing<T>({step_size(), bodies(0, i), x(2, i)},
             {x(0, i), x(1, i)},
             options_.substeps,
             y.col(i),
             [&](Index k, State<T> s) {
               states(2 * k, i) = s.angle, states(2 * k + 1, i) = s.speed;
             });
  }
}

template <class T>
void Pendulum<T>::pullback(const Tape& tape,
                           BatchIn<T> y_bar,
                           BatchOut<T> x_bar,
                           Workspace&) const {
  const auto bodies = tape.view<T>(kBodies), states = tape.view<T>(kStates);
  check_size(y_bar, kSights, states.cols());
  check_size(x_bar, 3, states.cols());
  const T h = step_size();
  for (Index i = 0; i < states.cols(); ++i) {
    T angle_bar = 0, speed_bar = 0, damping_bar = 0;
    for (Index k = kSights * options_.substeps - 1; k >= 0; --k) {
      if ((k + 1) % options_.substeps == 0)
        angle_bar += y_bar(k / options_.substeps, i);
      speed_bar = std::fma(h, angle_bar, speed_bar);
      const T force_bar = -h * speed_bar;
      damping_bar = std::fma(states(2 * k + 1, i), force_bar, damping_bar);
      speed_bar = std::fma(bodies(1, i), force_bar, speed_bar);
      angle_bar = std::fma(
          bodies(0, i) * math::cos(states(2 * k, i)), force_bar, angle_bar);
    }
    x_bar(0, i) = angle_bar, x_bar(1, i) = speed_bar, x_bar(2, i) = damping_bar;
  }
}

template class Pendulum<float>;
template class Pendulum<double>;

}  // namespace pendulum
