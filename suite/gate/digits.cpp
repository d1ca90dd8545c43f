#include "suite/gate/digits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "suite/core/math.h"
#include "suite/core/power_of_ten.h"

namespace physinv {

double log_distance(double a, double b) {
  if (std::isfinite(a) != std::isfinite(b))
    return std::copysign(std::numeric_limits<double>::infinity(),
                         std::isfinite(a) ? 1.0 : -1.0);
  if (!std::isfinite(a) || a == b) return 0;
  if (a > 0 && b > 0) return math::log10(b / a);
  return (b - a) / std::max(std::abs(a), std::abs(b));
}

double tolerance(int digits) {
  return digits == kNoDigits ? std::numeric_limits<double>::infinity()
                             : math::power_of_ten(-digits);
}

int stable_digits(double distance, int most) {
  if (distance == 0) return most;
  const double digits = std::floor(-math::log10(std::abs(distance))) - 1;
  return static_cast<int>(std::clamp(digits, double{kNoDigits}, double(most)));
}

}  // namespace physinv
