/// Packs: numbers side by side in one vector register, with elementwise
/// operators. Every lane runs the same instructions, so a number's bits depend
/// neither on its lane nor on its neighbours. Lanes that must not compute have
/// their *inputs* replaced (`select` before a division or root), so that no
/// lane raises a floating-point exception.
///
///   pack.h       packs, masks, fused operations, load and store
///   registers.h  several registers as one value; packs of fixed width
///   math.h       elementary functions
///   samples.h    columns of a batch as packs, and back
#pragma once

#ifdef __AVX__
#include <immintrin.h>
#elif defined(__ARM_NEON)
#include <arm_neon.h>
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

/// Lanes of the widest register.
template <class T>
inline constexpr int kLanes = kVectorBytes / static_cast<int>(sizeof(T));

/// Lanes of a register of 256 bits, the same on every processor.
template <class T>
inline constexpr Index kNarrowLanes = 32 / static_cast<Index>(sizeof(T));

/// The signed integer of T's size; what comparisons of packs consist of.
template <class T>
using LaneInt = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;

constexpr Index round_up(Index n, Index multiple) {
  return (n + multiple - 1) / multiple * multiple;
}

template <class T, int W>
struct PackOf {
  typedef T type __attribute__((vector_size(W * sizeof(T))));
};

/// W numbers with elementwise operators, comparisons (giving a `Mask`) and
/// access by index. Scalars of type T mix with packs.
template <class T, int W = kLanes<T>>
using Pack = typename PackOf<T, W>::type;

template <class T>
using NarrowPack = Pack<T, int(kNarrowLanes<T>)>;

/// The number type of a pack.
template <class P>
using LaneScalar = std::remove_cvref_t<decltype(std::declval<P>()[0])>;

/// All bits of a lane set (-1) or none (0); combine with & | ~.
template <class T, int W = kLanes<T>>
using Mask = Pack<LaneInt<T>, W>;

#define PHYSINV_LANES [[gnu::always_inline]] inline

template <class P, class T>
PHYSINV_LANES P broadcast(T s) {
  return s - P{};  // unlike P{} + s, keeps the sign of a zero
}

/// The numbers from p on; `p` need not be aligned.
template <class P, class T>
PHYSINV_LANES P load(const T* p) {
  if constexpr (requires { P::kRegisters; }) {
    return P::loaded(p);
  } else {
    P v;
    std::memcpy(&v, p, sizeof(P));
    return v;
  }
}

/// By value: accumulators whose address is taken stay in memory.
template <class T, class P>
PHYSINV_LANES void store(T* p, P v) {
  if constexpr (requires { P::kRegisters; }) {
    v.put(p);
  } else {
    std::memcpy(p, &v, sizeof(P));
  }
}

/// The first `count` lanes only; the others read as zero.
template <class P, class T>
PHYSINV_LANES P load_some(const T* p, Index count) {
  P v{};
  std::memcpy(&v, p, static_cast<std::size_t>(count) * sizeof(T));
  return v;
}

template <class T, class P>
PHYSINV_LANES void store_some(T* p, P v, Index count) {
  std::memcpy(p, &v, static_cast<std::size_t>(count) * sizeof(T));
}

/// The same, `count` being all of them as a rule.
template <class P, class T>
PHYSINV_LANES P load_lanes(const T* p, Index count) {
  constexpr auto all = static_cast<Index>(sizeof(P) / sizeof(T));
  return count == all ? load<P>(p) : load_some<P>(p, count);
}

template <class T, class P>
PHYSINV_LANES void store_lanes(T* p, P v, Index count) {
  constexpr auto all = static_cast<Index>(sizeof(P) / sizeof(T));
  if (count == all) {
    store(p, v);
  } else {
    store_some(p, v, count);
  }
}

/// body(i, lanes) for consecutive pieces of [0, size), the last of which may
/// have fewer lanes than a pack P. The body captures by value: it is inlined,
/// and its constants stay in registers.
template <class P, class F>
PHYSINV_LANES void for_pieces(Index size, F body) {
  constexpr auto w = static_cast<Index>(sizeof(P) / sizeof(LaneScalar<P>));
  Index i = 0;
  for (; i + w <= size; i += w) body(i, std::integral_constant<Index, w>{});
  if (i < size) body(i, size - i);
}

/// v, in a register: GCC would rather load it again for each of its uses, and
/// loads are what bounds a product whose factors come from the caches.
template <class P>
PHYSINV_LANES P held(P v) {
#ifdef __AVX__
  asm("" : "+v"(v));
#endif
  return v;
}

/// A pack of twice as many lanes.
template <class P>
PHYSINV_LANES auto side_by_side(P a, P b) {
  if constexpr (sizeof(P) == 8 * sizeof(a[0])) {
    return __builtin_shufflevector(
        a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  } else if constexpr (sizeof(P) == 4 * sizeof(a[0])) {
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
  } else {
    static_assert(sizeof(P) == 2 * sizeof(a[0]));
    return __builtin_shufflevector(a, b, 0, 1, 2, 3);
  }
}

/// The first (k = 0) or second (1) half of the lanes.
template <class P>
PHYSINV_LANES auto half_of(P v, int k) {
  Pack<LaneScalar<P>, int(sizeof(P) / sizeof(v[0]) / 2)> half[2];
  std::memcpy(half, &v, sizeof(v));
  return half[k];
}

/// f of each half: a pack of 256 bits takes two registers of ARM.
template <class F, class P, class... Q>
PHYSINV_LANES P by_halves(F f, P a, Q... more) {
  return side_by_side(f(half_of(a, 0), half_of(more, 0)...),
                      f(half_of(a, 1), half_of(more, 1)...));
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
#elif defined(__ARM_NEON)
  if constexpr (sizeof(P) == 32 && sizeof(x[0]) == 8)
    return by_halves([](auto h) { return Pack<double, 2>(vsqrtq_f64(h)); }, x);
  if constexpr (sizeof(P) == 32 && sizeof(x[0]) == 4)
    return by_halves([](auto h) { return Pack<float, 4>(vsqrtq_f32(h)); }, x);
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
#elif defined(__ARM_NEON) && defined(__clang__)  // GCC is better lane by lane
  if constexpr (sizeof(P) == 32 && sizeof(a[0]) == 8)
    return by_halves(
        [](auto x, auto y, auto z) {
          return Pack<double, 2>(vfmaq_f64(z, x, y));
        },
        a,
        b,
        c);
  if constexpr (sizeof(P) == 32 && sizeof(a[0]) == 4)
    return by_halves(
        [](auto x, auto y, auto z) {
          return Pack<float, 4>(vfmaq_f32(z, x, y));
        },
        a,
        b,
        c);
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

/// x where the mask is set, 0 elsewhere.
template <class M, class P>
PHYSINV_LANES P masked(M keep, P x) {
  return (P)((M)x & keep);
}

/// |x|, by its bits.
template <class P>
PHYSINV_LANES P abs_lanes(P x) {
  using T = LaneScalar<P>;
  using I = Mask<T, sizeof(P) / sizeof(T)>;
  return (P)((I)x & std::numeric_limits<LaneInt<T>>::max());
}

/// Sum of the lanes, halves onto halves.
template <class P>
PHYSINV_LANES LaneScalar<P> sum_of(P v) {
  using T = LaneScalar<P>;
  if constexpr (sizeof(P) == 2 * sizeof(T)) {
    return v[0] + v[1];
  } else {
    Pack<T, sizeof(P) / sizeof(T) / 2> half[2];
    std::memcpy(half, &v, sizeof(v));
    return sum_of(half[0] + half[1]);
  }
}

/// |x| > limit or NaN, decided on the bits: a comparison of a NaN as a number
/// would raise an exception.
template <class T, int W = kLanes<T>>
PHYSINV_LANES Mask<T, W> beyond(Pack<T, W> x, T limit) {
  constexpr auto kAbs = std::numeric_limits<LaneInt<T>>::max();
  return ((Mask<T, W>)x & kAbs) > std::bit_cast<LaneInt<T>>(limit);
}

}  // namespace physinv
