/// Eight doubles in two registers of 256 bits: for operations that eight
/// vectors side by side go through (row i is x[i]), and, where there is nothing
/// wider, for those of wide.h.
#pragma once

#include "suite/nn/vector.h"

namespace physinv::hig {

/// Four numbers to a register.
using Four = nn::Simd<double, 32>;
using FourFlags = nn::Simd<std::int64_t, 32>;

/// What comparisons of eight give.
struct EightFlags {
  FourFlags low, high;
};

struct Eight {
  Four low, high;

  static constexpr Index kCount = 8;

  double operator[](Index l) const { return l < 4 ? low[l] : high[l - 4]; }

#define PHYSINV_EIGHT(op)                                                  \
  PHYSINV_LANES friend Eight operator op(const Eight& x, const Eight& y) { \
    return {x.low op y.low, x.high op y.high};                             \
  }                                                                        \
  PHYSINV_LANES friend Eight operator op(double s, const Eight& x) {       \
    return {s op x.low, s op x.high};                                      \
  }
  PHYSINV_EIGHT(+)
  PHYSINV_EIGHT(-)
  PHYSINV_EIGHT(*)
  PHYSINV_EIGHT(/)
#undef PHYSINV_EIGHT
  PHYSINV_LANES friend Eight operator-(const Eight& x) {
    return {-x.low, -x.high};
  }
  PHYSINV_LANES Eight& operator+=(const Eight& y) { return *this = *this + y; }

#define PHYSINV_EIGHT(op)                                       \
  PHYSINV_LANES friend EightFlags operator op(const Eight& x,   \
                                              const Eight& y) { \
    return {x.low op y.low, x.high op y.high};                  \
  }
  PHYSINV_EIGHT(<)
  PHYSINV_EIGHT(>)
  PHYSINV_EIGHT(>=)
  PHYSINV_EIGHT(==)
#undef PHYSINV_EIGHT
};

}  // namespace physinv::hig
