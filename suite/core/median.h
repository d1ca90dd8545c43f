/// The middle of a list, by the one rule that everything here uses.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace physinv {

/// Of a list that is not empty and without NaN; of an even number the mean of
/// the two in the middle. Infinities are numbers here.
inline double median(std::vector<double> values) {
  const auto half = static_cast<std::ptrdiff_t>(values.size() / 2);
  const auto upper = values.begin() + half;
  std::nth_element(values.begin(), upper, values.end());
  if (values.size() % 2 == 1) return *upper;
  return std::midpoint(*std::max_element(values.begin(), upper), *upper);
}

/// Of an even number the larger of the two in the middle, so that it is one of
/// the values.
inline double median_high(std::vector<double> values) {
  const auto half = static_cast<std::ptrdiff_t>(values.size() / 2);
  const auto upper = values.begin() + half;
  std::nth_element(values.begin(), upper, values.end());
  return *upper;
}

}  // namespace physinv
