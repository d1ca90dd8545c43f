/// Bilinear lookup in a plane, each sample at a place of its own, with its
/// slopes and its transpose.
///
///   a = floor(x), b = floor(y), wx = x - a, wy = y - b
///   corners c = f[a][b], f[a][b+1], f[a+1][b], f[a+1][b+1]
///   low = c0 + wy (c1 - c0), high = c2 + wy (c3 - c2)
///   value = low + wx (high - low); slopes are those of the right side
///
/// Every coordinate is safe, however large: beyond the padding everything is
/// zero (Edge::zero), or the place is taken modulo the extents.
#pragma once

#include "problems/fluid/plane.h"

namespace physinv::fluid {

/// The lesser and the greater, a if neither is: what the instructions do.
template <class P>
PHYSINV_LANES P least(P a, P b) {
#ifdef PHYSINV_AVX512
  if constexpr (sizeof(P) == 64 && sizeof(a[0]) == 8)
    return _mm512_maskz_min_pd(0xff, b, a);
#endif
#ifdef __AVX2__
  if constexpr (sizeof(P) == 32 && sizeof(a[0]) == 8)
    return _mm256_min_pd(b, a);
  if constexpr (sizeof(P) == 32 && sizeof(a[0]) == 4)
    return _mm256_min_ps(b, a);
#endif
  return select(b < a, b, a);
}
template <class P>
PHYSINV_LANES P most(P a, P b) {
#ifdef PHYSINV_AVX512
  if constexpr (sizeof(P) == 64 && sizeof(a[0]) == 8)
    return _mm512_maskz_max_pd(0xff, b, a);
#endif
#ifdef __AVX2__
  if constexpr (sizeof(P) == 32 && sizeof(a[0]) == 8)
    return _mm256_max_pd(b, a);
  if constexpr (sizeof(P) == 32 && sizeof(a[0]) == 4)
    return _mm256_max_ps(b, a);
#endif
  return select(b > a, b, a);
}

template <class P>
PHYSINV_LANES P floor_lanes(P x) {
#ifdef PHYSINV_AVX512
  if constexpr (sizeof(P) == 64 && sizeof(x[0]) == 8)
    return _mm512_maskz_roundscale_pd(
        0xff, x, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
#endif
#ifdef __AVX2__
  if constexpr (sizeof(P) == 32 && sizeof(x[0]) == 8) return _mm256_floor_pd(x);
  if constexpr (sizeof(P) == 32 && sizeof(x[0]) == 4) return _mm256_floor_ps(x);
#elif defined(__aarch64__)
  if constexpr (sizeof(P) == 32 && sizeof(x[0]) == 8)
    return by_halves([](auto h) { return Pack<double, 2>(vrndmq_f64(h)); }, x);
  if constexpr (sizeof(P) == 32 && sizeof(x[0]) == 4)
    return by_halves([](auto h) { return Pack<float, 4>(vrndmq_f32(h)); }, x);
#endif
  P below = x;
  for (std::size_t k = 0; k < sizeof(P) / sizeof(x[0]); ++k)
    below[k] = std::floor(x[k]);
  return below;
}

/// base[index[k]] in lane k; one by one, as the processors' own gathers are no
/// faster.
template <class P, class I>
PHYSINV_LANES P gather(const LaneScalar<P>* base, const I& index) {
  P out;
#pragma GCC unroll 16
  for (int k = 0; k < kWidthOf<P>; ++k) out[k] = base[index[k]];
  return out;
}

/// A cell of four corners and the place in it.
template <class P>
struct CellPoint {
  using I = Mask<LaneScalar<P>, kWidthOf<P>>;
  I corner;  ///< of f[a][b], counted in numbers from f[0][0]
  P wx, wy;
};

/// A value and d/dx, d/dy.
template <class P>
struct Interpolated {
  P value, dx, dy;
};

template <Edge kEdge, class P>
class Lookup {
 public:
  using T = LaneScalar<P>;
  using I = typename CellPoint<P>::I;
  static constexpr int W = kWidthOf<P>;

  explicit Lookup(const Plane& plane)
      : origin_(plane.at(0, 0)), stride_(plane.stride) {
    extent_[0] = static_cast<T>(plane.rows);
    extent_[1] = static_cast<T>(plane.columns);
    for (int k = 0; k < W; ++k) lane_[k] = k;
  }

  PHYSINV_LANES CellPoint<P> find(P x, P y) const {
    x = inside(x, extent_[0]), y = inside(y, extent_[1]);
    const P a = floor_lanes(x), b = floor_lanes(y);
    const P stride = P{} + static_cast<T>(stride_);
    const P magic = P{} + kRounder<T>;
    const I point = (I)(fma_lanes(a, stride, b) + magic) - (I)magic;
    return {point * W + lane_, x - a, y - b};
  }

  PHYSINV_LANES void read(const P* f, const CellPoint<P>& s, P (&c)[4]) const {
    const T* const p = reinterpret_cast<const T*>(f + origin_);
    c[0] = gather<P>(p, s.corner), c[1] = gather<P>(p + W, s.corner);
    c[2] = gather<P>(p + stride_ * W, s.corner);
    c[3] = gather<P>(p + (stride_ + 1) * W, s.corner);
  }

  PHYSINV_LANES static Interpolated<P> interpolate(const P (&c)[4],
                                                   const CellPoint<P>& s) {
    const P left = c[1] - c[0], right = c[3] - c[2];
    const P low = fma_lanes(s.wy, left, c[0]);
    const P dx = fma_lanes(s.wy, right, c[2]) - low;
    return {fma_lanes(s.wx, dx, low), dx, fma_lanes(s.wx, right - left, left)};
  }

  PHYSINV_LANES Interpolated<P> interpolate(const P* f,
                                            const CellPoint<P>& s) const {
    P c[4];
    read(f, s, c);
    return interpolate(c, s);
  }

  /// h times the weights of the corners.
  PHYSINV_LANES static void weigh(P h, const CellPoint<P>& s, P (&c)[4]) {
    const P high = h * s.wx, low = h - high;
    c[1] = low * s.wy, c[0] = low - c[1];
    c[3] = high * s.wy, c[2] = high - c[3];
  }

  /// Adds a number to each corner. Lanes never share one, so that the order
  /// of the calls is all that the sums depend on.
  PHYSINV_LANES void add(P* f, const CellPoint<P>& s, const P (&c)[4]) const {
    T* const p = reinterpret_cast<T*>(f + origin_);
    alignas(64) T part[4][W];
    alignas(64) LaneInt<T> corner[W];
    std::memcpy(part, c, sizeof(part));
    std::memcpy(corner, &s.corner, sizeof(corner));
#pragma GCC unroll 16
    for (int k = 0; k < W; ++k) {
      T* const at = p + corner[k];
      T* const next = at + stride_ * W;
      at[0] += part[0][k], at[W] += part[1][k];
      next[0] += part[2][k], next[W] += part[3][k];
    }
  }

 private:
  PHYSINV_LANES static P inside(P x, T extent) {
    const auto clamp = [](P v, T low, T high) {
      return least(P{} + high, most(P{} + low, v));
    };
    if constexpr (kEdge == Edge::zero) {
      return clamp(x, -T(Plane::kPad), extent);
    } else {
      constexpr T kTurns = 1 << 20;
      const P turns = clamp(held(x * (1 / extent)), -kTurns, kTurns);
      return clamp(fma_lanes(floor_lanes(turns), P{} - extent, x), 0, extent);
    }
  }

  Index origin_, stride_;
  T extent_[2];
  I lane_{};
};

}  // namespace physinv::fluid
