#include "problems/sine_plane/sine_plane.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

enum Slot : std::size_t { kCosine };

/// The turn and the scales of its axes.
struct Frame {
  explicit Frame(const SinePlaneOptions& o)
      : a(o.gamma / o.xi),
        b(o.gamma * o.xi),
        c(math::cos(o.degrees * std::numbers::pi / 180)),
        s(math::sin(o.degrees * std::numbers::pi / 180)) {}

  /// R v and R^T v.
  Pair turned(double x, double y) const {
    return {std::fma(c, x, -s * y), std::fma(s, x, c * y)};
  }
  Pair back(double w1, double w2) const {
    return {std::fma(c, w1, s * w2), std::fma(-s, w1, c * w2)};
  }
  /// u of x.
  Pair scaled(double x, double y) const {
    const Pair w = turned(x, y);
    return {a * w[0], b * w[1]};
  }

  double a, b, c, s;
};

/// Gradient and curvature of the loss along the axes of the turned frame.
struct Model {
  Model(const Frame& f, const Pair& x, const Pair& target) {
    const Pair u = f.scaled(x[0], x[1]);
    const auto [sine, cosine] = math::sincos(u[0]);
    const double r = sine - target[0];
    q = {f.a * r * cosine, f.b * (u[1] - target[1])};
    curvature = {f.a * f.a * std::fma(cosine, cosine, -r * sine), f.b * f.b};
  }
  Pair q, curvature;
};

double quotient(double over, double under) {
  return under == 0 ? 0 : std::abs(over / under);
}

double signed_as(double q, double size) {
  return q == 0 ? 0 : std::copysign(size, q);
}

Pair step_of(const Frame& f, double limit, const Pair& x, const Pair& target) {
  const Model m(f, x, target);
  const double middle = std::sqrt(std::abs(m.curvature[0] * m.curvature[1]));
  Pair n;
  for (std::size_t i = 0; i < 2; ++i) {
    n[i] = quotient(m.q[i], m.curvature[i]);
    if (!(m.curvature[i] > middle))
      n[i] = std::min(n[i], quotient(limit, m.q[i]));
  }
  // A slope that is not finite has no sign.
  if (!std::isfinite(m.q[0]) || !std::isfinite(m.q[1]))
    return {std::nan(""), std::nan("")};
  return f.back(-signed_as(m.q[0], n[0]), -signed_as(m.q[1], n[1]));
}

template <class T>
Pair column(BatchIn<T> x, Index i) {
  return {static_cast<double>(x(0, i)), static_cast<double>(x(1, i))};
}

template <class T>
void put(BatchOut<T> to, Index i, const Pair& v) {
  to(0, i) = static_cast<T>(v[0]), to(1, i) = static_cast<T>(v[1]);
}

}  // namespace

// Each family of solutions repeats with the period of the sine; in the turned
// frame the two unknowns are independent of each other, so that the nearest of
// each is the nearest of all.
Pair nearest_solution(const SinePlaneOptions& options,
                      const Pair& x,
                      const Pair& y) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const Frame f(options);
  const Pair u = f.scaled(x[0], x[1]);
  const double s = math::asin(std::clamp(y[0], -1.0, 1.0));
  const auto next = [&](double root) {
    return root + kTurn * std::round((u[0] - root) / kTurn);
  };
  const double rising = next(s), falling = next(std::numbers::pi - s);
  const double nearest =
      std::abs(rising - u[0]) <= std::abs(falling - u[0]) ? rising : falling;
  return f.back(nearest / f.a, y[1] / f.b);
}

Pair limited_newton_step(const SinePlaneOptions& options,
                         const Pair& x,
                         const Pair& target) {
  return step_of(Frame(options), options.limit, x, target);
}

namespace {

template <class T>
class SinePlane final : public Problem<T>,
                        public Vjp<T>,
                        public Jacobian<T>,
                        public Hessian<T>,
                        public Inverse<T> {
 public:
  explicit SinePlane(const SinePlaneOptions& options) : options_(options) {
    check_numbers<T>({{"gamma", options.gamma},
                      {"xi", options.xi},
                      {"degrees", options.degrees}});
    SUITE_CHECK(options.gamma > 0 && options.xi > 0 && options.limit > 0,
                "gamma, xi and limit must be positive");
  }

  Shape shape() const override { return {2, 2, 0}; }
  Vector<double> start() const override { return Vector<double>::Zero(2); }

  /// x is the solution nearest to 0 of some y in [-1, 1]^2.
  void draw(Stream& stream, SampleOut& sample) const override {
    const double first = stream.uniform(-1, 1), second = stream.uniform(-1, 1);
    const Pair x = nearest_solution(options_, {0, 0}, {first, second});
    sample.x << x[0], x[1];
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    const Frame f(options_);
    for (Index i = 0; i < y.cols(); ++i) {
      const Pair p = column<T>(at.x, i), u = f.scaled(p[0], p[1]);
      put<T>(y, i, {math::sincos(u[0]).sine, u[1]});
    }
  }
  /// Keeps the derivative of the sine.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const Frame f(options_);
    auto cosine = tape.slot<double>(kCosine, 1, y.cols());
    for (Index i = 0; i < y.cols(); ++i) {
      const Pair p = column<T>(at.x, i), u = f.scaled(p[0], p[1]);
      const auto [sine, slope] = math::sincos(u[0]);
      put<T>(y, i, {sine, u[1]});
      cosine(0, i) = slope;
    }
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    const Frame f(options_);
    const auto cosine = tape.view<double>(kCosine);
    for (Index i = 0; i < cosine.cols(); ++i) {
      const Pair bar = column<T>(y_bar, i);
      put<T>(x_bar, i, f.back(f.a * cosine(0, i) * bar[0], f.b * bar[1]));
    }
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace&) const override {
    const Frame f(options_);
    for (Index i = 0; i < j.cols(); ++i) {
      const Pair p = column<T>(at.x, i), u = f.scaled(p[0], p[1]);
      const double slope = f.a * math::sincos(u[0]).cosine;
      const Pair first = f.back(slope, 0), second = f.back(0, f.b);
      for (Index k = 0; k < 2; ++k) {
        j(2 * k, i) = static_cast<T>(first[static_cast<std::size_t>(k)]);
        j(2 * k + 1, i) = static_cast<T>(second[static_cast<std::size_t>(k)]);
      }
    }
  }
  void hessian(Point<T> at,
               BatchIn<T> target,
               BatchOut<T> h,
               Workspace&) const override {
    const Frame f(options_);
    for (Index i = 0; i < target.cols(); ++i) {
      const Model m(f, column<T>(at.x, i), column<T>(target, i));
      const auto [s1, s2] = m.curvature;
      const double off = (s2 - s1) * f.c * f.s;
      h(0, i) = static_cast<T>(std::fma(s1 * f.c, f.c, s2 * f.s * f.s));
      h(1, i) = h(2, i) = static_cast<T>(off);
      h(3, i) = static_cast<T>(std::fma(s1 * f.s, f.s, s2 * f.c * f.c));
    }
  }
  void invert(Point<T> near,
              BatchIn<T> y,
              BatchOut<T> x,
              Workspace&) const override {
    const Frame f(options_);
    for (Index i = 0; i < y.cols(); ++i) {
      const Pair guess = column<T>(near.x, i);
      const Pair dx = step_of(f, options_.limit, guess, column<T>(y, i));
      put<T>(x, i, {guess[0] + dx[0], guess[1] + dx[1]});
    }
  }

  double operations() const override { return 50; }

 private:
  SinePlaneOptions options_;
};

}  // namespace

ProblemRecipe problems::sine_plane(const SinePlaneOptions& options) {
  return problem<SinePlane>(
      "sine_plane",
      options,
      {.unknowns = {"x_1, x_2"}, .observations = {"y_1, y_2"}});
}

}  // namespace physinv
