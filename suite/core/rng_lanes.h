/// W random streams side by side: xoshiro128+ (Blackman, Vigna 2018, the
/// 32-bit generator made for floating point), every lane seeded with 128 bits
/// of a stream of its own. For statistics that draw many millions of numbers;
/// data and weights of a case come from `Stream`.
#pragma once

#include <cstdint>

#include "suite/core/lanes.h"
#include "suite/core/rng.h"

namespace physinv {

template <class T, int W = kLanes<T>>
class StreamLanes {
 public:
  using P = Pack<T, W>;

  /// Lane k follows stream_of(k).
  template <class F>
  explicit StreamLanes(F&& stream_of) {
    for (int k = 0; k < W; ++k) {
      Stream stream = stream_of(k);
      const std::uint64_t a = stream.bits(), b = stream.bits();
      s0_[k] = static_cast<std::uint32_t>(a);
      s1_[k] = static_cast<std::uint32_t>(a >> 32);
      s2_[k] = static_cast<std::uint32_t>(b);
      s3_[k] = static_cast<std::uint32_t>(b >> 32) | 1U;  // never all zero
    }
  }

  /// Uniform in [0, 2^24), whole numbers: the same in float and double.
  PHYSINV_LANES P whole() {
    const Bits sum = s0_ + s3_, shifted = s1_ << 9;
    s2_ ^= s0_, s3_ ^= s1_, s1_ ^= s2_, s0_ ^= s3_, s2_ ^= shifted;
    s3_ = (s3_ << 11) | (s3_ >> 21);
    return __builtin_convertvector((SignedBits)(sum >> 8), P);
  }
  static constexpr T kUnit = T(0x1p-24);

  /// Uniform in [0, 1), and in [lo, hi).
  PHYSINV_LANES P uniform() { return whole() * kUnit; }
  PHYSINV_LANES P uniform(T lo, T hi) {
    return whole() * ((hi - lo) * kUnit) + lo;
  }

 private:
  using Bits = Pack<std::uint32_t, W>;
  using SignedBits = Pack<std::int32_t, W>;
  Bits s0_{}, s1_{}, s2_{}, s3_{};
};

}  // namespace physinv
