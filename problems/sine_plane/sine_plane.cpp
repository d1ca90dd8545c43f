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
  // A slope that is not finite has no sign to go by.
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

template <class T>
SinePlane<T>::SinePlane(const Options& options) : options_(options) {
  check_numbers<T>({{"gamma", options.gamma},
                    {"xi", options.xi},
                    {"degrees", options.degrees}});
  SUITE_CHECK(options.gamma > 0 && options.xi > 0 && options.limit > 0,
              "gamma, xi and limit must be positive");
}

template <class T>
Samples<double> SinePlane<T>::sample(Index first,
                                     Index count,
                                     const Rng& rng) const {
  Samples<double> out;
  out.x.resize(2, count), out.y.resize(2, count), out.given.resize(0, count);
  for (Index i = 0; i < count; ++i) {
    Stream stream = rng.child(static_cast<std::uint64_t>(first + i)).stream();
    out.y(0, i) = stream.uniform(-1, 1);
    out.y(1, i) = stream.uniform(-1, 1);
    put<double>(
        out.x, i, nearest_solution(options_, {0, 0}, column<double>(out.y, i)));
  }
  // The observation of that very x, to the last bit.
  Workspace work;
  SinePlane<double>(options_).forward(out.x, out.given, out.y, work);
  return out;
}

template <class T>
void SinePlane<T>::forward(BatchIn<T> x,
                           BatchIn<T> /*given*/,
                           BatchOut<T> y,
                           Workspace& /*work*/) const {
  check_size(x, 2, y.cols());
  check_size(y, 2, x.cols());
  const Frame f(options_);
  for (Index i = 0; i < x.cols(); ++i) {
    const Pair at = column<T>(x, i), u = f.scaled(at[0], at[1]);
    put<T>(y, i, {math::sincos(u[0]).sine, u[1]});
  }
}

template <class T>
void SinePlane<T>::linearize(BatchIn<T> x,
                             BatchIn<T> /*given*/,
                             BatchOut<T> y,
                             Tape& tape) const {
  check_size(x, 2, y.cols());
  check_size(y, 2, x.cols());
  const Frame f(options_);
  auto cosine = tape.slot<double>(kCosine, 1, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const Pair at = column<T>(x, i), u = f.scaled(at[0], at[1]);
    const auto [sine, slope] = math::sincos(u[0]);
    put<T>(y, i, {sine, u[1]});
    cosine(0, i) = slope;
  }
}

template <class T>
void SinePlane<T>::pullback(const Tape& tape,
                            BatchIn<T> y_bar,
                            BatchOut<T> x_bar,
                            Workspace& /*work*/) const {
  const Frame f(options_);
  const auto cosine = tape.view<double>(kCosine);
  check_size(y_bar, 2, cosine.cols());
  check_size(x_bar, 2, cosine.cols());
  for (Index i = 0; i < cosine.cols(); ++i) {
    const Pair bar = column<T>(y_bar, i);
    put<T>(x_bar, i, f.back(f.a * cosine(0, i) * bar[0], f.b * bar[1]));
  }
}

template <class T>
void SinePlane<T>::jacobian(BatchIn<T> x,
                            BatchIn<T> /*given*/,
                            BatchOut<T> j,
                            Workspace& /*work*/) const {
  check_size(j, 4, x.cols());
  const Frame f(options_);
  for (Index i = 0; i < x.cols(); ++i) {
    const Pair at = column<T>(x, i), u = f.scaled(at[0], at[1]);
    const double slope = f.a * math::sincos(u[0]).cosine;
    const Pair first = f.back(slope, 0), second = f.back(0, f.b);
    for (Index k = 0; k < 2; ++k) {
      j(2 * k, i) = static_cast<T>(first[static_cast<std::size_t>(k)]);
      j(2 * k + 1, i) = static_cast<T>(second[static_cast<std::size_t>(k)]);
    }
  }
}

template <class T>
void SinePlane<T>::hessian(BatchIn<T> x,
                           BatchIn<T> /*given*/,
                           BatchIn<T> target,
                           BatchOut<T> h,
                           Workspace& /*work*/) const {
  check_size(h, 4, x.cols());
  const Frame f(options_);
  for (Index i = 0; i < x.cols(); ++i) {
    const Model m(f, column<T>(x, i), column<T>(target, i));
    const auto [s1, s2] = m.curvature;
    const double off = (s2 - s1) * f.c * f.s;
    h(0, i) = static_cast<T>(std::fma(s1 * f.c, f.c, s2 * f.s * f.s));
    h(1, i) = h(2, i) = static_cast<T>(off);
    h(3, i) = static_cast<T>(std::fma(s1 * f.s, f.s, s2 * f.c * f.c));
  }
}

template <class T>
void SinePlane<T>::invert(BatchIn<T> y,
                          BatchIn<T> /*given*/,
                          BatchIn<T> x_guess,
                          BatchOut<T> x,
                          Workspace& /*work*/) const {
  check_size(y, 2, x.cols());
  check_size(x_guess, 2, x.cols());
  check_size(x, 2, x.cols());
  const Frame f(options_);
  for (Index i = 0; i < x.cols(); ++i) {
    const Pair at = column<T>(x_guess, i);
    const Pair dx = step_of(f, options_.limit, at, column<T>(y, i));
    put<T>(x, i, {at[0] + dx[0], at[1] + dx[1]});
  }
}

template class SinePlane<float>;
template class SinePlane<double>;

}  // namespace physinv
