/// Eight vectors side by side, for operations that all of them go through:
/// row i is x[i].
#pragma once

#include "suite/nn/vector.h"

namespace physinv::hig {

/// Four numbers to a register.
using Four = nn::Simd<double, 32>;

struct Eight {
  Four low{}, high{};

  static constexpr Index kCount = 8;

  friend Eight operator*(double s, const Eight& x) {
    return {s * x.low, s * x.high};
  }
  friend Eight operator+(const Eight& x, const Eight& y) {
    return {x.low + y.low, x.high + y.high};
  }
  friend Eight operator-(const Eight& x, const Eight& y) {
    return {x.low - y.low, x.high - y.high};
  }
};

}  // namespace physinv::hig
