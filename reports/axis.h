/// Axes: a range, its ticks and where a value falls.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace physinv {

struct Tick {
  double value = 0;
  std::string label;  ///< empty for a minor tick
};

class Axis {
 public:
  Axis() = default;
  explicit Axis(bool log) : log_(log) {}

  /// True if the value can be drawn: at most 1e300, positive on a log axis.
  bool shows(double value) const;
  /// Widens the range to a value; what cannot be shown is ignored.
  void include(double value);
  /// Ends widening: room at both ends, except at an end that is given.
  void finish(std::optional<double> lo = {}, std::optional<double> hi = {});
  /// The range without room at the ends.
  void finish_tight();

  bool log() const { return log_; }
  bool empty() const { return empty_; }
  double lo() const { return lo_; }
  double hi() const { return hi_; }

  /// 0 at the lower end, 1 at the upper; limited to -2..3, so that far points
  /// keep short coordinates. `shows(value)` must hold.
  double place(double value) const;

  /// About `wanted` ticks. A log axis whose included values all are powers of
  /// two is marked at those; else decades, with 2 and 5 on short ranges.
  std::vector<Tick> ticks(int wanted) const;

 private:
  std::vector<Tick> linear_ticks(int wanted) const;
  std::vector<Tick> decade_ticks(int wanted) const;
  std::vector<Tick> binary_ticks(int wanted) const;
  double warp(double value) const;
  double unwarp(double value) const;

  bool log_ = false, empty_ = true, powers_of_two_ = true;
  double lo_ = 0, hi_ = 1, least_ = 0, most_ = 1;
};

}  // namespace physinv
