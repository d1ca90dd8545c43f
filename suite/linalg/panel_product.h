/// Products with a thin panel: the `count` memory rows X_k, `stride` numbers
/// apart, several of them in one pass over the other vector. Lengths are
/// rounded up to whole registers, so rows and vectors are padded.
#pragma once

#include "suite/linalg/tile_product.h"

namespace physinv::linalg {

/// Rows whose products with one vector stay in registers.
#ifdef __aarch64__
inline constexpr int kDots = 4;
#else
inline constexpr int kDots = kParts == 1 ? 8 : 6;
#endif

/// f.operator()<kRows>(k) for groups of kMost, 2 and 1 rows that cover `count`.
template <int kMost, class F>
void for_row_groups(Index count, F&& f) {
  Index k = 0;
  for (; k + kMost <= count; k += kMost) f.template operator()<kMost>(k);
  for (; k + 2 <= count; k += 2) f.template operator()<2>(k);
  if (k < count) f.template operator()<1>(k);
}

/// y -= sum_k s_k X_k and z -= sum_k t_k X_k.
inline void subtract_combinations(Index n,
                                  Index count,
                                  const double* s,
                                  const double* t,
                                  const double* x,
                                  Index stride,
                                  double* y,
                                  double* z) {
  for_row_groups<4>(count, [&]<int kRows>(Index k) {
    const double* const from = x + k * stride;
    Pack8 by_s[kRows], by_t[kRows];
#pragma GCC unroll 4
    for (int i = 0; i < kRows; ++i)
      by_s[i] = broadcast(-s[k + i]), by_t[i] = broadcast(-t[k + i]);
    for (Index c = 0; c < n; c += kWidth) {
      Pack8 to_y = load(y + c), to_z = load(z + c);
#pragma GCC unroll 4
      for (int i = 0; i < kRows; ++i) {
        const Pack8 v = held(load(from + i * stride + c));
        to_y = fma_lanes(by_s[i], v, to_y);
        to_z = fma_lanes(by_t[i], v, to_z);
      }
      store(y + c, to_y), store(z + c, to_z);
    }
  });
}

/// s_k = X_k.v.
inline void project(Index n,
                    Index count,
                    const double* x,
                    Index stride,
                    const double* v,
                    double* s) {
  for_row_groups<kDots>(count, [&]<int kRows>(Index k) {
    const double* const from = x + k * stride;
    Pack8 dots[kRows] = {};
    for (Index c = 0; c < n; c += kWidth) {
      const Pack8 vc = held(load(v + c));
#pragma GCC unroll 8
      for (int i = 0; i < kRows; ++i)
        dots[i] = fma_lanes(load(from + i * stride + c), vc, dots[i]);
    }
#pragma GCC unroll 8
    for (int i = 0; i < kRows; ++i) s[k + i] = sum_of(dots[i]);
  });
}

}  // namespace physinv::linalg
