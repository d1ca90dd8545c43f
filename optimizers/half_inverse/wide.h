/// Eight doubles that go through every operation together: one register of 512
/// bits, or two of 256. Their number decides about the order of sums and about
/// who searches with whom, so it is the same everywhere, and so are the bits.
#pragma once

#include <cstdint>

#include "optimizers/half_inverse/eight.h"
#include "suite/core/lanes_math.h"

namespace physinv::hig {

inline constexpr Index kWidth = 8;

#ifdef PHYSINV_AVX512

using Wide = nn::Simd<double, 64>;
using Flags = nn::Simd<std::int64_t, 64>;

PHYSINV_LANES Wide broadcast(double s) { return nn::broadcast<Wide>(s); }
PHYSINV_LANES Wide fma(Wide a, Wide b, Wide c) { return fma_lanes(a, b, c); }
PHYSINV_LANES Wide root(Wide x) { return sqrt_lanes(x); }
PHYSINV_LANES Wide magnitude(Wide x) { return abs_lanes(x); }
PHYSINV_LANES Wide masked(Flags keep, Wide x) {
  return (Wide)((Flags)x & keep);
}
PHYSINV_LANES double sum(Wide x) { return nn::sum_of(x); }
PHYSINV_LANES bool any_of(Flags f) { return any(f); }
PHYSINV_LANES Wide load(const double* p) { return nn::load<Wide>(p); }
PHYSINV_LANES void store(double* p, Wide v) { nn::store(p, v); }
PHYSINV_LANES Flags load_flags(const std::int64_t* p) {
  return nn::load<Flags>(p);
}

#else

using Wide = Eight;
using Flags = EightFlags;

PHYSINV_LANES Wide broadcast(double s) {
  const Four v = nn::broadcast<Four>(s);
  return {v, v};
}
PHYSINV_LANES Wide fma(const Wide& a, const Wide& b, const Wide& c) {
  return {fma_lanes(a.low, b.low, c.low), fma_lanes(a.high, b.high, c.high)};
}
PHYSINV_LANES Wide root(const Wide& x) {
  return {sqrt_lanes(x.low), sqrt_lanes(x.high)};
}
PHYSINV_LANES Wide magnitude(const Wide& x) {
  return {abs_lanes(x.low), abs_lanes(x.high)};
}
PHYSINV_LANES Wide select(const Flags& f, const Wide& a, const Wide& b) {
  return {physinv::select(f.low, a.low, b.low),
          physinv::select(f.high, a.high, b.high)};
}
PHYSINV_LANES Wide masked(const Flags& keep, const Wide& x) {
  return {(Four)((FourFlags)x.low & keep.low),
          (Four)((FourFlags)x.high & keep.high)};
}
/// In the order of one register of 512 bits.
PHYSINV_LANES double sum(const Wide& x) { return nn::sum_of(x.low + x.high); }
PHYSINV_LANES bool any_of(const Flags& f) { return any(f.low | f.high); }
PHYSINV_LANES Wide held(const Wide& x) {
  return {physinv::held(x.low), physinv::held(x.high)};
}
/// Register by register: GCC copies more bytes than a register holds through
/// memory, half a register at a time, and the load behind that waits.
PHYSINV_LANES Wide load(const double* p) {
  return {nn::load<Four>(p), nn::load<Four>(p + 4)};
}
PHYSINV_LANES void store(double* p, const Wide& v) {
  nn::store(p, v.low);
  nn::store(p + 4, v.high);
}
PHYSINV_LANES Flags load_flags(const std::int64_t* p) {
  return {nn::load<FourFlags>(p), nn::load<FourFlags>(p + 4)};
}

#endif

}  // namespace physinv::hig
