/// 10^k, correctly rounded, which a `pow` is not always.
#pragma once

#include <charconv>
#include <cmath>

#include "suite/core/math.h"

namespace physinv::math {

inline double power_of_ten(int k) {
  char text[16] = "1e";
  const char* end = std::to_chars(text + 2, text + sizeof(text), k).ptr;
  double value = 0;
  std::from_chars(text, end, value);
  return value;
}

/// The same of a number, with an error below 1 ulp where it is not whole.
inline double power_of_ten(double x) {
  return x == std::trunc(x) && std::abs(x) < 400
             ? power_of_ten(static_cast<int>(x))
             : pow(10.0, x);
}

}  // namespace physinv::math
