#include "optimizers/steps/line_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace physinv {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Slope-weighted root term of the cubic through two points; `floor` keeps the
/// radicand from going below zero by rounding.
double cubic_gamma(double theta, double da, double db, bool floor) {
  const double s = std::max({std::abs(theta), std::abs(da), std::abs(db)});
  double radicand = (theta / s) * (theta / s) - (da / s) * (db / s);
  if (floor) radicand = std::max(0.0, radicand);
  return s * std::sqrt(radicand);
}

/// Minimiser of the cubic through (a, f, slope), (b, fb), (c, fc), or NaN.
double cubic_minimiser(double a,
                       double f,
                       double slope,
                       double b,
                       double fb,
                       double c,
                       double fc) {
  const double db = b - a, dc = c - a;
  const double scale = (db * dc) * (db * dc) * (db - dc);
  const double rb = fb - f - slope * db, rc = fc - f - slope * dc;
  const double k3 = (dc * dc * rb - db * db * rc) / scale;
  const double k2 = (-dc * dc * dc * rb + db * db * db * rc) / scale;
  return a + (-k2 + std::sqrt(k2 * k2 - 3 * k3 * slope)) / (3 * k3);
}

/// Minimiser of the parabola through (a, f, slope), (b, fb), or not finite.
double quadratic_minimiser(
    double a, double f, double slope, double b, double fb) {
  const double db = b - a;
  return a - slope / (2 * ((fb - f - slope * db) / (db * db)));
}

}  // namespace

using Next = LineSearch::Next;

Next LineSearch::start(const LineSearchOptions& options,
                       double f,
                       double slope,
                       double first_step) {
  origin_ = {0, f, slope};
  first_step_ = first_step;
  round_ = evaluations_ = 0;
  if (!(slope < 0) || !(first_step >= options.min_step) ||
      first_step > options.max_step) {
    return start_doubling(options);
  }
  phase_ = Phase::more_thuente;
  x_ = y_ = origin_;
  bracketed_ = false;
  modified_ = true;
  width_ = options.max_step - options.min_step;
  width_before_ = 2 * width_;
  lower_ = 0;
  upper_ = first_step + 4 * first_step;
  step_ = first_step;
  return Next::evaluate;
}

Next LineSearch::supply(const LineSearchOptions& options,
                        double f,
                        double slope) {
  const Next next = move_on(options, f, slope);
  const bool spent = ++evaluations_ >= options.max_together;
  return spent && next == Next::evaluate ? Next::fail : next;
}

Next LineSearch::move_on(const LineSearchOptions& options,
                         double f,
                         double slope) {
  const bool finite = std::isfinite(f) && std::isfinite(slope);
  if (options.back_off && !finite) f = kInf;
  // Search 2 halves its interval where the loss is +inf; the slope there is not
  // read.
  const bool comparable = finite || f == kInf;
  const Point p{step_, f, slope};
  switch (phase_) {
    case Phase::more_thuente:
      return finite ? more_thuente(options, p) : start_doubling(options);
    case Phase::doubling:
      return comparable ? doubling(options, p) : Next::nonfinite;
    case Phase::zoom:
      return comparable ? zoom(options, p) : Next::nonfinite;
  }
  return Next::fail;
}

// ---- search 1 --------------------------------------------------------------

Next LineSearch::more_thuente(const LineSearchOptions& options, Point p) {
  const double descent = options.decrease * origin_.d;
  const double limit = origin_.f + p.a * descent;
  const bool low = p.f <= limit;
  if (low && p.d >= std::min(options.decrease, options.curvature) * origin_.d)
    modified_ = false;
  if (low && std::abs(p.d) <= -options.curvature * origin_.d)
    return Next::accept;
  if (hopeless(options, p))
    return options.search_1_only ? Next::accept : start_doubling(options);
  if (++round_ >= options.max_evaluations) return start_doubling(options);

  if (modified_ && p.f <= x_.f && !low) {
    // Stage 1 works on psi(a) = phi(a) - c1 a phi'(0) until it has a point
    // with psi <= 0 and psi' >= 0.
    const auto tilt = [&](Point& q, double sign) {
      q.f += sign * q.a * descent;
      q.d += sign * descent;
    };
    tilt(x_, -1);
    tilt(y_, -1);
    tilt(p, -1);
    interpolate(p);
    tilt(x_, 1);
    tilt(y_, 1);
  } else {
    interpolate(p);
  }

  if (bracketed_) {
    const double width = std::abs(y_.a - x_.a);
    if (width >= 0.66 * width_before_) step_ = x_.a + (y_.a - x_.a) / 2;
    width_before_ = width_;
    width_ = width;
    lower_ = std::min(x_.a, y_.a);
    upper_ = std::max(x_.a, y_.a);
  } else {
    lower_ = step_ + 1.1 * (step_ - x_.a);
    upper_ = step_ + 4 * (step_ - x_.a);
  }
  step_ = std::clamp(step_, options.min_step, options.max_step);
  if (bracketed_ && (step_ <= lower_ || step_ >= upper_ ||
                     upper_ - lower_ <= options.xtol * upper_)) {
    step_ = x_.a;
  }
  return std::isfinite(step_) ? Next::evaluate : start_doubling(options);
}

bool LineSearch::hopeless(const LineSearchOptions& options, Point p) const {
  const double descent = options.decrease * origin_.d;
  const bool low = p.f <= origin_.f + p.a * descent;
  if (bracketed_ && (p.a <= lower_ || p.a >= upper_ ||
                     upper_ - lower_ <= options.xtol * upper_)) {
    return true;
  }
  if (p.a == options.max_step && low && p.d <= descent) return true;
  return p.a == options.min_step && (!low || p.d >= descent);
}

namespace {

/// Of the cubic through values and slopes of two points.
template <class Point>
double theta_of(const Point& x, const Point& p) {
  return 3 * (x.f - p.f) / (p.a - x.a) + x.d + p.d;
}

template <class Point>
double secant(const Point& x, const Point& p) {
  return p.a + p.d / (p.d - x.d) * (x.a - p.a);
}

}  // namespace

/// Case 1, higher: the minimum is bracketed.
double LineSearch::step_from_higher(Point p) const {
  const Point x = x_;
  const double ahead = p.a - x.a;  // signed distance from the best point
  const double theta = theta_of(x, p);
  double gamma = cubic_gamma(theta, x.d, p.d, false);
  if (p.a < x.a) gamma = -gamma;
  const double r = ((gamma - x.d) + theta) / (((gamma - x.d) + gamma) + p.d);
  const double cubic = x.a + r * ahead;
  const double quadratic = x.a + x.d / ((x.f - p.f) / ahead + x.d) / 2 * ahead;
  return std::abs(cubic - x.a) <= std::abs(quadratic - x.a)
             ? cubic
             : cubic + (quadratic - cubic) / 2;
}

/// Case 2, lower, the slope changed sign: bracketed, too.
double LineSearch::step_from_turned(Point p) const {
  const Point x = x_;
  const double theta = theta_of(x, p);
  double gamma = cubic_gamma(theta, x.d, p.d, false);
  if (p.a > x.a) gamma = -gamma;
  const double r = ((gamma - p.d) + theta) / (((gamma - p.d) + gamma) + x.d);
  const double cubic = p.a + r * (x.a - p.a);
  const double quadratic = secant(x, p);
  return std::abs(cubic - p.a) > std::abs(quadratic - p.a) ? cubic : quadratic;
}

/// Case 3, lower, flatter.
double LineSearch::step_from_flatter(Point p) const {
  const Point x = x_, y = y_;
  const double theta = theta_of(x, p);
  double gamma = cubic_gamma(theta, x.d, p.d, true);
  if (p.a > x.a) gamma = -gamma;
  const double r = ((gamma - p.d) + theta) / ((gamma + (x.d - p.d)) + gamma);
  double cubic = p.a > x.a ? upper_ : lower_;
  if (r < 0 && gamma != 0) cubic = p.a + r * (x.a - p.a);
  const double quadratic = secant(x, p);
  const bool cubic_closer = std::abs(cubic - p.a) < std::abs(quadratic - p.a);
  const bool cubic_farther = std::abs(cubic - p.a) > std::abs(quadratic - p.a);
  if (bracketed_) {
    const double limit = p.a + 0.66 * (y.a - p.a);
    const double next = cubic_closer ? cubic : quadratic;
    return p.a > x.a ? std::min(limit, next) : std::max(limit, next);
  }
  const double next = cubic_farther ? cubic : quadratic;
  return std::min(std::max(next, lower_), upper_);
}

/// Case 4, lower, not flatter.
double LineSearch::step_from_steep(Point p) const {
  const Point x = x_, y = y_;
  if (!bracketed_) return p.a > x.a ? upper_ : lower_;
  const double theta = 3 * (p.f - y.f) / (y.a - p.a) + y.d + p.d;
  double gamma = cubic_gamma(theta, y.d, p.d, false);
  if (p.a > y.a) gamma = -gamma;
  const double r = ((gamma - p.d) + theta) / (((gamma - p.d) + gamma) + y.d);
  return p.a + r * (y.a - p.a);
}

/// One safeguarded step (MINPACK-2 dcstep): moves x_, y_, step_, bracketed_.
void LineSearch::interpolate(Point p) {
  const Point x = x_;
  const double turn = p.d * ((x.d > 0) - (x.d < 0));
  if (p.f > x.f) {
    step_ = step_from_higher(p);
    bracketed_ = true;
    y_ = p;
    return;
  }
  if (turn < 0) {
    step_ = step_from_turned(p);
    bracketed_ = true;
    y_ = x;
  } else if (std::abs(p.d) < std::abs(x.d)) {
    step_ = step_from_flatter(p);
  } else {
    step_ = step_from_steep(p);
  }
  x_ = p;
}

// ---- search 2 --------------------------------------------------------------

Next LineSearch::start_doubling(const LineSearchOptions& options) {
  if (options.search_1_only || first_step_ == 0) return Next::fail;
  step_ = std::min(first_step_, options.max_step);
  if (!std::isfinite(step_) || std::isnan(origin_.d)) return Next::nonfinite;
  phase_ = Phase::doubling;
  x_ = origin_;
  round_ = 0;
  return Next::evaluate;
}

Next LineSearch::doubling(const LineSearchOptions& options, Point p) {
  if (round_ == options.max_doublings)
    return p.f < kInf ? Next::accept : Next::nonfinite;
  const double limit = origin_.f + options.decrease * p.a * origin_.d;
  if (p.f > limit || (round_ > 0 && p.f >= x_.f)) return start_zoom(x_, p);
  // No absolute value on the right: never true while the slope at 0 rises.
  if (std::abs(p.d) <= -options.curvature * origin_.d) return Next::accept;
  if (p.d >= 0) return start_zoom(p, x_);
  x_ = p;
  step_ = std::min(2 * p.a, options.max_step);
  ++round_;
  return Next::evaluate;
}

Next LineSearch::start_zoom(Point lo, Point hi) {
  phase_ = Phase::zoom;
  x_ = lo;
  y_ = hi;
  old_ = origin_;
  round_ = 0;
  step_ = zoom_trial();
  return Next::evaluate;
}

Next LineSearch::zoom(const LineSearchOptions& options, Point p) {
  const double limit = origin_.f + options.decrease * p.a * origin_.d;
  if (p.f > limit || p.f >= x_.f) {
    old_ = std::exchange(y_, p);
  } else {
    if (std::abs(p.d) <= -options.curvature * origin_.d) return Next::accept;
    if (p.d * (y_.a - x_.a) >= 0) {
      old_ = std::exchange(y_, x_);
    } else {
      old_ = x_;
    }
    x_ = p;
  }
  if (++round_ == options.max_zooms) return Next::fail;
  step_ = zoom_trial();
  return Next::evaluate;
}

/// Cubic, else quadratic, else the midpoint. The margins use the signed length
/// hi - lo, as SciPy does: for hi < lo the test is looser.
double LineSearch::zoom_trial() const {
  const double length = y_.a - x_.a;
  const double left = std::min(x_.a, y_.a), right = std::max(x_.a, y_.a);
  const auto inside = [&](double a, double margin) {
    return a <= right - margin && a >= left + margin;  // false for NaN
  };
  const double cubic =
      round_ == 0
          ? kNone
          : cubic_minimiser(x_.a, x_.f, x_.d, y_.a, y_.f, old_.a, old_.f);
  if (std::isfinite(cubic) && inside(cubic, 0.2 * length)) return cubic;
  const double quadratic = quadratic_minimiser(x_.a, x_.f, x_.d, y_.a, y_.f);
  if (std::isfinite(quadratic) && inside(quadratic, 0.1 * length))
    return quadratic;
  return x_.a + 0.5 * length;
}

}  // namespace physinv
