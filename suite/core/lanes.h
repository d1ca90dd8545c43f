/// Lanes: W samples side by side in one vector register, one register per row
/// (structure of arrays). Kernels transpose blocks of columns into lanes,
/// compute, and transpose back; nobody else sees the layout.
///
/// Every lane runs the same instructions, so a sample's bits depend neither on
/// its position in the batch nor on its neighbours. Short blocks are padded.
/// Lanes that must not compute have their *inputs* replaced (`select` before a
/// division or root), so that no lane raises a floating-point exception.
#pragma once

#ifdef __AVX__
#include <immintrin.h>
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "suite/core/batch.h"

namespace physinv {

#ifdef PHYSINV_AVX512
inline constexpr int kVectorBytes = 64;
#else
inline constexpr int kVectorBytes = 32;
#endif

/// Samples per register.
template <class T>
inline constexpr int kLanes = kVectorBytes / static_cast<int>(sizeof(T));

/// The signed integer of T's size; what comparisons of packs consist of.
template <class T>
using LaneInt = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;

template <class T, int W>
struct PackOf {
  typedef T type __attribute__((vector_size(W * sizeof(T))));
};

/// W numbers with elementwise operators, comparisons (giving a `Mask`) and
/// access by index. Scalars of type T mix with packs.
template <class T, int W = kLanes<T>>
using Pack = typename PackOf<T, W>::type;

/// All bits of a lane set (-1) or none (0); combine with & | ~.
template <class T, int W = kLanes<T>>
using Mask = Pack<LaneInt<T>, W>;

#define PHYSINV_LANES [[gnu::always_inline]] inline

/// v, in a register: GCC would rather load it again for each of its uses, and
/// loads are what bounds a product whose factors come from the caches.
template <class P>
PHYSINV_LANES P held(P v) {
#ifdef __AVX__
  asm("" : "+v"(v));
#endif
  return v;
}

/// a where the mask is set, b elsewhere.
template <class M, class P>
PHYSINV_LANES P select(M mask, P a, P b) {
  return mask ? a : b;
}

/// Square root of every lane; the caller keeps negative numbers out.
template <class P>
PHYSINV_LANES P sqrt_lanes(P x) {
#ifdef PHYSINV_AVX512
  if constexpr (sizeof(P) == 64 && sizeof(x[0]) == 8)
    return _mm512_maskz_sqrt_pd(0xff, x);
  if constexpr (sizeof(P) == 64 && sizeof(x[0]) == 4)
    return _mm512_maskz_sqrt_ps(0xffff, x);
#endif
#ifdef __AVX__
  if constexpr (sizeof(P) == 32 && sizeof(x[0]) == 8) return _mm256_sqrt_pd(x);
  if constexpr (sizeof(P) == 32 && sizeof(x[0]) == 4) return _mm256_sqrt_ps(x);
#endif
  P root = x;
  for (std::size_t k = 0; k < sizeof(P) / sizeof(x[0]); ++k)
    root[k] = std::sqrt(x[k]);
  return root;
}

/// a b + c, rounded once. Products and sums fuse here and where std::fma is
/// written, nowhere else (-ffp-contract=off).
template <class P>
PHYSINV_LANES P fma_lanes(P a, P b, P c) {
#ifdef PHYSINV_AVX512
  if constexpr (sizeof(P) == 64 && sizeof(a[0]) == 8)
    return _mm512_fmadd_pd(a, b, c);
  if constexpr (sizeof(P) == 64 && sizeof(a[0]) == 4)
    return _mm512_fmadd_ps(a, b, c);
#endif
#ifdef __FMA__
  if constexpr (sizeof(P) == 32 && sizeof(a[0]) == 8)
    return _mm256_fmadd_pd(a, b, c);
  if constexpr (sizeof(P) == 32 && sizeof(a[0]) == 4)
    return _mm256_fmadd_ps(a, b, c);
#endif
  P out = c;
  for (std::size_t k = 0; k < sizeof(P) / sizeof(a[0]); ++k)
    out[k] = std::fma(a[k], b[k], c[k]);
  return out;
}

/// The same with one factor for all lanes.
template <class P>
PHYSINV_LANES P fma_lanes(std::remove_cvref_t<decltype(P{}[0])> a, P b, P c) {
  return fma_lanes(a - P{}, b, c);
}

/// Is any lane set?
template <class M>
PHYSINV_LANES bool any(M mask) {
#ifdef __AVX__
  if constexpr (sizeof(M) == 32)
    return _mm256_testz_si256((__m256i)mask, (__m256i)mask) == 0;
#endif
  std::int64_t bits = 0;
  for (std::size_t k = 0; k < sizeof(M) / sizeof(mask[0]); ++k) bits |= mask[k];
  return bits != 0;
}

/// How many lanes are set.
template <class M>
PHYSINV_LANES Index count_set(M mask) {
  Index count = 0;
  for (std::size_t k = 0; k < sizeof(M) / sizeof(mask[0]); ++k)
    count -= static_cast<Index>(mask[k]);
  return count;
}

/// |x| > limit or NaN, decided on the bits: a comparison of a NaN as a number
/// would raise an exception.
template <class T, int W = kLanes<T>>
PHYSINV_LANES Mask<T, W> beyond(Pack<T, W> x, T limit) {
  constexpr auto kAbs = std::numeric_limits<LaneInt<T>>::max();
  return ((Mask<T, W>)x & kAbs) > std::bit_cast<LaneInt<T>>(limit);
}

/// Lanes of the rows of one block: a view of `rows` packs.
///
///   Pack<T> v[2];
///   Lanes<T>(v, 2).load(x, first);   // v[r][k] = x(r, first + k)
template <class T, int W = kLanes<T>>
class Lanes {
 public:
  using P = Pack<T, W>;

  Lanes(P* packs, Index rows) : packs_(packs), rows_(rows) {}

  static constexpr Index blocks(Index columns) { return (columns + W - 1) / W; }

  /// Columns first .. first+W-1; those beyond the batch read as `pad`.
  PHYSINV_LANES void load(BatchIn<T> batch, Index first, T pad = T(0)) {
    const Index stride = batch.outerStride();
    const Index count = std::min<Index>(W, batch.cols() - first);
    const T* p = batch.data() + first * stride;
    if (rows_ == 2 && stride == 2 && count == W) {
      P pairs[2];
      std::memcpy(pairs, p, sizeof(pairs));
      return part(pairs[0], pairs[1], packs_[0], packs_[1], kAll);
    }
    if (rows_ == 4 && stride == 4 && count == W) return load_fours(p);
    for (Index r = 0; r < rows_; ++r) {
      alignas(sizeof(P)) T lane[W];
      for (Index k = 0; k < W; ++k)
        lane[k] = k < count ? p[k * stride + r] : pad;
      std::memcpy(&packs_[r], lane, sizeof(P));
    }
  }

  /// The reverse; columns beyond the batch are dropped.
  PHYSINV_LANES void store(BatchOut<T>& batch, Index first) const {
    const Index stride = batch.outerStride();
    const Index count = std::min<Index>(W, batch.cols() - first);
    T* p = batch.data() + first * stride;
    if (rows_ == 2 && stride == 2 && count == W) {
      P pairs[2];
      join(packs_[0], packs_[1], pairs[0], pairs[1], kAll);
      return static_cast<void>(std::memcpy(p, pairs, sizeof(pairs)));
    }
    if (rows_ == 4 && stride == 4 && count == W) return store_fours(p);
    for (Index r = 0; r < rows_; ++r) {
      alignas(sizeof(P)) T lane[W];
      std::memcpy(lane, &packs_[r], sizeof(P));
      for (Index k = 0; k < count; ++k) p[k * stride + r] = lane[k];
    }
  }

 private:
  static constexpr auto kAll = std::make_integer_sequence<int, W>();

  /// The numbers of even and of odd place of a, b.
  template <int... I>
  PHYSINV_LANES static void part(
      P a, P b, P& even, P& odd, std::integer_sequence<int, I...>) {
    even = __builtin_shufflevector(a, b, (2 * I)...);
    odd = __builtin_shufflevector(a, b, (2 * I + 1)...);
  }

  /// The reverse.
  template <int... I>
  PHYSINV_LANES static void join(
      P even, P odd, P& a, P& b, std::integer_sequence<int, I...>) {
    a = __builtin_shufflevector(even, odd, (I / 2 + I % 2 * W)...);
    b = __builtin_shufflevector(even, odd, (W / 2 + I / 2 + I % 2 * W)...);
  }

  /// Rows 0 and 2 alternate in `even`, 1 and 3 in `odd`.
  PHYSINV_LANES void load_fours(const T* p) {
    P in[4], even[2], odd[2];
    std::memcpy(in, p, sizeof(in));
    part(in[0], in[1], even[0], odd[0], kAll);
    part(in[2], in[3], even[1], odd[1], kAll);
    part(even[0], even[1], packs_[0], packs_[2], kAll);
    part(odd[0], odd[1], packs_[1], packs_[3], kAll);
  }

  PHYSINV_LANES void store_fours(T* p) const {
    P out[4], even[2], odd[2];
    join(packs_[0], packs_[2], even[0], even[1], kAll);
    join(packs_[1], packs_[3], odd[0], odd[1], kAll);
    join(even[0], odd[0], out[0], out[1], kAll);
    join(even[1], odd[1], out[2], out[3], kAll);
    std::memcpy(p, out, sizeof(out));
  }

  P* packs_;
  Index rows_;
};

}  // namespace physinv
