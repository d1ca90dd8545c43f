/// Several registers as one value, for two purposes:
///
///   Wide<T, N>         N of the widest registers: a chain of dependent
///                      operations runs at the latency of one operation per
///                      register, and independent ones hide each other's
///   FixedPack<T, W>    W lanes whatever a register holds: where their number
///                      decides about the order of sums, it is the same on
///                      every processor, and so are the bits
///
/// `std::experimental::simd` has fixed widths too, but what GCC 12 makes of
/// them goes through memory, and it has no shuffles; Highway's packs end at the
/// register, so that a fixed width over two of them is left to its user.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "suite/core/simd/pack.h"

namespace physinv {

template <class P, int N>
struct Registers {
  static constexpr int kRegisters = N;
  static constexpr Index kSize = sizeof(P) / sizeof(LaneScalar<P>);
  static constexpr Index kCount = N * kSize;
  using T = LaneScalar<P>;
  using Flags = Registers<Mask<T, int(kSize)>, N>;

  P r[N];

  T operator[](Index lane) const { return r[lane / kSize][lane % kSize]; }

  /// Register k is f(k).
  template <class F>
  PHYSINV_LANES static Registers make(F&& f) {
    Registers all;
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) all.r[k] = f(k);
    return all;
  }
  /// Register by register: GCC copies more bytes than a register holds through
  /// memory, half a register at a time, and the load behind that waits.
  PHYSINV_LANES static Registers loaded(const T* p) {
    return make([&](int k) { return load<P>(p + k * kSize); });
  }
  PHYSINV_LANES void put(T* p) const {
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) store(p + k * kSize, r[k]);
  }

#define PHYSINV_REGISTERS(op)                                           \
  PHYSINV_LANES friend Registers operator op(const Registers& a,        \
                                             const Registers& b) {      \
    return make([&](int k) { return a.r[k] op b.r[k]; });               \
  }                                                                     \
  PHYSINV_LANES friend Registers operator op(P a, const Registers& b) { \
    return make([&](int k) { return a op b.r[k]; });                    \
  }                                                                     \
  PHYSINV_LANES friend Registers operator op(T a, const Registers& b) { \
    return make([&](int k) { return a op b.r[k]; });                    \
  }
  PHYSINV_REGISTERS(+)
  PHYSINV_REGISTERS(-)
  PHYSINV_REGISTERS(*)
  PHYSINV_REGISTERS(/)
#undef PHYSINV_REGISTERS
  PHYSINV_LANES friend Registers operator-(const Registers& a) {
    return make([&](int k) { return -a.r[k]; });
  }
  PHYSINV_LANES Registers& operator+=(const Registers& b) {
    return *this = *this + b;
  }

#define PHYSINV_REGISTERS(op)                                    \
  PHYSINV_LANES friend Flags operator op(const Registers& a,     \
                                         const Registers& b) {   \
    return Flags::make([&](int k) { return a.r[k] op b.r[k]; }); \
  }
  PHYSINV_REGISTERS(<)
  PHYSINV_REGISTERS(>)
  PHYSINV_REGISTERS(>=)
  PHYSINV_REGISTERS(==)
#undef PHYSINV_REGISTERS

  /// a b + c, rounded once.
  PHYSINV_LANES friend Registers fma_lanes(const Registers& a,
                                           const Registers& b,
                                           const Registers& c) {
    return make([&](int k) { return fma_lanes(a.r[k], b.r[k], c.r[k]); });
  }
  PHYSINV_LANES friend Registers fma_lanes(P a,
                                           const Registers& b,
                                           const Registers& c) {
    return make([&](int k) { return fma_lanes(a, b.r[k], c.r[k]); });
  }
  PHYSINV_LANES friend Registers fma_lanes(T a,
                                           const Registers& b,
                                           const Registers& c) {
    return make([&](int k) { return fma_lanes(a, b.r[k], c.r[k]); });
  }
};

/// One factor, addend, .. stands for all registers.
template <class T, int N>
using Wide = Registers<Pack<T>, N>;

/// W lanes on one register, or on as many as it takes.
template <class T, int W>
using FixedPack =
    std::conditional_t<W <= kLanes<T>,
                       Pack<T, W>,
                       Registers<Pack<T>, (W + kLanes<T> - 1) / kLanes<T>>>;

template <class P, int N>
PHYSINV_LANES Registers<P, N> sqrt_lanes(const Registers<P, N>& x) {
  return x.make([&](int k) { return sqrt_lanes(x.r[k]); });
}
template <class P, int N>
PHYSINV_LANES Registers<P, N> abs_lanes(const Registers<P, N>& x) {
  return x.make([&](int k) { return abs_lanes(x.r[k]); });
}
template <class P, int N>
PHYSINV_LANES Registers<P, N> held(const Registers<P, N>& x) {
  return x.make([&](int k) { return held(x.r[k]); });
}
template <class M, class P, int N>
PHYSINV_LANES Registers<P, N> select(const Registers<M, N>& mask,
                                     const Registers<P, N>& a,
                                     const Registers<P, N>& b) {
  return a.make([&](int k) { return select(mask.r[k], a.r[k], b.r[k]); });
}
template <class M, class P, int N>
PHYSINV_LANES Registers<P, N> masked(const Registers<M, N>& keep,
                                     const Registers<P, N>& x) {
  return x.make([&](int k) { return masked(keep.r[k], x.r[k]); });
}
template <class M, int N>
PHYSINV_LANES bool any(const Registers<M, N>& mask) {
  M all = mask.r[0];
#pragma GCC unroll 8
  for (int k = 1; k < N; ++k) all = all | mask.r[k];
  return any(all);
}
/// In the order of one register of as many lanes.
template <class P>
PHYSINV_LANES LaneScalar<P> sum_of(const Registers<P, 2>& x) {
  return sum_of(x.r[0] + x.r[1]);
}

}  // namespace physinv
