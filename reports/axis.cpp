#include "reports/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/text.h"
#include "suite/core/math.h"
#include "suite/core/power_of_ten.h"

namespace physinv {
namespace {

bool is_power_of_two(double value) {
  int exponent = 0;
  return value >= 1 && std::frexp(value, &exponent) == 0.5;
}

std::string with_minus(std::string text) {
  return text.front() == '-' ? "−" + text.substr(1) : text;
}

std::string power_label(double mantissa, int exponent) {
  const std::string power = "10" + superscript(exponent);
  if (mantissa == 1) return power;
  return with_minus(fmt::format("{:.4g}·{}", mantissa, power));
}

std::string linear_label(double value, double step, double largest) {
  if (value == 0) return "0";
  if (largest >= 1e5 || largest < 1e-3) {
    const int e = static_cast<int>(std::floor(math::log10(std::abs(value))));
    return power_label(value / math::power_of_ten(e), e);
  }
  // 2.5 needs a digit more than 2.
  int digits = std::max(0, static_cast<int>(-std::floor(math::log10(step))));
  const double scaled = step * math::power_of_ten(digits);
  if (std::abs(scaled - std::round(scaled)) > 1e-6) ++digits;
  return with_minus(fmt::format("{:.{}f}", value, digits));
}

}  // namespace

bool Axis::shows(double value) const {
  // The limit keeps the length of a range finite; NaN fails it too.
  return std::abs(value) <= 1e300 && (!log_ || value > 0);
}

double Axis::warp(double value) const {
  return log_ ? math::log10(value) : value;
}
double Axis::unwarp(double value) const {
  return log_ ? math::power_of_ten(value) : value;
}

void Axis::include(double value) {
  if (!shows(value)) return;
  powers_of_two_ = powers_of_two_ && is_power_of_two(value);
  lo_ = empty_ ? value : std::min(lo_, value);
  hi_ = empty_ ? value : std::max(hi_, value);
  least_ = lo_, most_ = hi_;
  empty_ = false;
}

void Axis::finish(std::optional<double> lo, std::optional<double> hi) {
  if (empty_) lo_ = log_ ? 0.1 : 0, hi_ = 1;
  if (lo && shows(*lo)) lo_ = *lo;
  if (hi && shows(*hi)) hi_ = *hi;
  double a = warp(lo_), b = warp(hi_);
  if (!(b - a > 1e-12 * std::max(std::abs(a), std::abs(b)))) {
    const double room = log_ ? 0.5 : std::max(0.5 * std::abs(a), 0.5);
    a -= room, b += room;
  } else {
    const double room = 0.04 * (b - a);
    if (!lo) a -= room;
    if (!hi) b += room;
  }
  if (log_) a = std::max(a, -305.0), b = std::min(b, 305.0);
  lo_ = unwarp(a), hi_ = unwarp(b);
}

void Axis::finish_tight() {
  if (lo_ < hi_) return;
  finish();
}

double Axis::place(double value) const {
  const double a = warp(lo_), b = warp(hi_);
  return std::clamp((warp(value) - a) / (b - a), -2.0, 3.0);
}

std::vector<Tick> Axis::ticks(int wanted) const {
  if (!log_) return linear_ticks(wanted);
  if (!empty_ && powers_of_two_ && most_ / least_ <= 4096) {
    return binary_ticks(wanted);
  }
  return decade_ticks(wanted);
}

std::vector<Tick> Axis::linear_ticks(int wanted) const {
  const double rough = (hi_ - lo_) / std::max(wanted, 1);
  const double unit = math::power_of_ten(std::floor(math::log10(rough)));
  double step = 10 * unit;
  for (const double m : {5.0, 2.5, 2.0, 1.0}) {
    if (m * unit >= 0.85 * rough) step = m * unit;
  }
  const double slack = 1e-9 * (hi_ - lo_);
  const double first = std::ceil((lo_ - slack) / step);
  const double largest = std::max(std::abs(lo_), std::abs(hi_));
  std::vector<Tick> ticks;
  for (int i = 0; i < 40; ++i) {
    const double value = (first + i) * step;
    if (value > hi_ + slack) break;
    ticks.push_back({value, linear_label(value, step, largest)});
  }
  return ticks;
}

std::vector<Tick> Axis::decade_ticks(int wanted) const {
  const double a = math::log10(lo_), b = math::log10(hi_);
  if (b - a < 0.5) return linear_ticks(wanted);
  const bool plain = a > -2.6 && b < 4.1;
  const auto label = [&](double mantissa, int e) {
    return plain ? fmt::format("{:.6g}", mantissa * math::power_of_ten(e))
                 : power_label(mantissa, e);
  };
  const int stride =
      std::max(1, static_cast<int>(std::ceil((b - a) / std::max(wanted, 1))));
  const bool between = b - a < 2.2;
  std::vector<Tick> ticks;
  for (int e = static_cast<int>(std::floor(a)); e <= b; ++e) {
    // A common phase (multiples of the stride) keeps panels comparable.
    if (e % stride != 0) continue;
    for (const double m : {1.0, 2.0, 5.0}) {
      if (m > 1 && !between) break;
      const double at = e + math::log10(m);
      if (at < a - 1e-9 || at > b + 1e-9) continue;
      ticks.push_back({m * math::power_of_ten(e), label(m, e)});
    }
  }
  return ticks;
}

std::vector<Tick> Axis::binary_ticks(int wanted) const {
  const int spread = static_cast<int>(std::lround(math::log2(most_ / least_)));
  const int stride = std::max(1, (spread + wanted) / std::max(wanted + 1, 1));
  std::vector<Tick> ticks;
  for (int e = 0; e <= spread; e += stride) {
    const double value = std::ldexp(least_, e);
    ticks.push_back({value, fmt::format("{:.0f}", value)});
  }
  return ticks;
}

}  // namespace physinv
