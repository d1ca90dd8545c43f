/// How the experiments of the half-inverse-gradients paper name and order
/// their runs.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "suite/core/math.h"
#include "suite/core/power_of_ten.h"
#include "suite/harness/case.h"

namespace physinv {

/// Rates are a digit times a power of ten: 3e-4, 1e1.
inline std::string rate_id(double rate) {
  const int exponent = static_cast<int>(std::floor(math::log10(rate) + 1e-9));
  return fmt::format(
      "{:.0f}e{}", rate / math::power_of_ten(exponent), exponent);
}

/// Makes the rows of an experiment: one n and one precision.
struct RowOf {
  Index n;
  Precision precision = Precision::f64;

  Row operator()(std::vector<std::string> ids,
                 std::vector<std::uint64_t> seeds,
                 Index updates) const {
    return {.methods = std::move(ids),
            .n = {n},
            .seeds = std::move(seeds),
            .iterations = updates,
            .precision = precision};
  }
};

}  // namespace physinv
