/// 10^k, correctly rounded, which a `pow` is not always.
#pragma once

#include <charconv>

namespace physinv::math {

inline double power_of_ten(int k) {
  char text[16] = "1e";
  const char* end = std::to_chars(text + 2, text + sizeof(text), k).ptr;
  double value = 0;
  std::from_chars(text, end, value);
  return value;
}

}  // namespace physinv::math
