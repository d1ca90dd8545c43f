/// W random streams side by side: xoshiro128+ (Blackman, Vigna 2018, the
/// 32-bit generator made for floating point), every lane seeded with 128 bits
/// of a stream of its own. For statistics that draw many millions of numbers;
/// data and weights of a case come from `Stream`.
#pragma once

#include <cstdint>

#include "suite/core/rng.h"
#include "suite/core/simd/pack.h"

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
  PHYSINV_LANES P whole() { return number(bits() >> 8); }
  static constexpr T kUnit = T(0x1p-24);

  /// Uniform in [0, 1), and in [lo, hi).
  PHYSINV_LANES P uniform() { return whole() * kUnit; }
  PHYSINV_LANES P uniform(T lo, T hi) {
    return whole() * ((hi - lo) * kUnit) + lo;
  }

  /// Three independent numbers from two draws, for loops that the draws bound:
  /// uniform in [0, 2^21), [0, 2^21) and [-2^23, 2^23), whole.
  struct Three {
    P a, b, c;
  };
  PHYSINV_LANES Three whole_three() {
    const Bits x = bits(), y = bits();
    // c: the bits that a and b leave of x, then those of y. Below the former
    // lie bits of b too, which the xor makes independent of it.
    const auto c = (SignedBits)(x << 21 ^ y << 10) >> 8;
    return {number(x >> 11), number(y >> 11), number((Bits)c)};
  }

 private:
  using Bits = Pack<std::uint32_t, W>;
  using SignedBits = Pack<std::int32_t, W>;

  PHYSINV_LANES Bits bits() {
    const Bits sum = s0_ + s3_, shifted = s1_ << 9;
    s2_ ^= s0_, s3_ ^= s1_, s1_ ^= s2_, s0_ ^= s3_, s2_ ^= shifted;
    s3_ = (s3_ << 11) | (s3_ >> 21);
    return sum;
  }
  PHYSINV_LANES static P number(Bits bits) {
    return __builtin_convertvector((SignedBits)bits, P);
  }

  Bits s0_{}, s1_{}, s2_{}, s3_{};
};

}  // namespace physinv
