/// Strong-Wolfe line search of one example as a resumable state machine:
/// the caller evaluates f and slope wherever `step()` points and hands them
/// back, so the searches of a whole batch share their evaluations.
///
/// Search 1 is More & Thuente (ACM TOMS 20, 1994; MINPACK-2 dcsrch); if it
/// fails, search 2 (Nocedal & Wright, algorithms 3.5 and 3.6: bracket, then
/// zoom) starts again from the first trial step, as in SciPy 1.10. Values that
/// are not finite fail search 1. In search 2 a loss of +inf is above any limit,
/// as in SciPy, so that the interval is halved; SciPy would continue with NaN,
/// which here ends search 2 with `nonfinite`, or counts as +inf (`back_off`).
#pragma once

#include <cstdint>

namespace physinv {

struct LineSearchOptions {
  double decrease = 1e-4;  ///< c1, sufficient decrease
  double curvature = 0.9;  ///< c2, |slope| <= c2 |slope at 0|
  double xtol = 1e-14;     ///< relative width of a bracket worth searching
  double min_step = 1e-100;
  double max_step = 1e100;
  int max_evaluations = 99;  ///< of search 1
  int max_doublings = 10;    ///< rounds of search 2
  int max_zooms = 11;        ///< rounds inside its bracket
  int max_together = 1000;   ///< evaluations of both searches
  /// Without search 2, as L-BFGS-B has it: where rounding or an end of the
  /// range leaves search 1 nothing to try, its step is accepted.
  bool search_1_only = false;
  /// In search 2 all that is not finite counts as a loss of +inf.
  bool back_off = false;
};

class LineSearch {
 public:
  enum class Next : std::uint8_t {
    evaluate,   ///< call `supply` with f and slope at `step()`
    accept,     ///< `step()`, the point just supplied, fulfils the conditions
    fail,       ///< no acceptable step
    nonfinite,  ///< search 2 met NaN or -inf
  };

  /// f and slope g.p at step 0, and the first trial step >= 0.
  Next start(const LineSearchOptions& options,
             double f,
             double slope,
             double first_step);
  Next supply(const LineSearchOptions& options, double f, double slope);

  double step() const { return step_; }

 private:
  struct Point {
    double a, f, d;  // step, value, slope
  };
  enum class Phase : std::uint8_t { more_thuente, doubling, zoom };

  Next move_on(const LineSearchOptions& options, double f, double slope);
  Next more_thuente(const LineSearchOptions& options, Point p);
  bool hopeless(const LineSearchOptions& options, Point p) const;
  void interpolate(Point p);
  double step_from_higher(Point p) const;
  double step_from_turned(Point p) const;
  double step_from_flatter(Point p) const;
  double step_from_steep(Point p) const;
  Next start_doubling(const LineSearchOptions& options);
  Next doubling(const LineSearchOptions& options, Point p);
  Next start_zoom(Point lo, Point hi);
  Next zoom(const LineSearchOptions& options, Point p);
  double zoom_trial() const;

  // x_ is the best point and y_ the other end of search 1; the previous point
  // of the doublings; lo and hi of the zoom, whose last discarded is old_.
  Point origin_, x_, y_, old_;
  double first_step_, step_;
  double lower_, upper_, width_, width_before_;
  int round_, evaluations_;
  Phase phase_;
  bool bracketed_, modified_;
};

}  // namespace physinv
