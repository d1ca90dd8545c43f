/// Householder reflectors H = I - tau v v^T with v_0 = 1.
#pragma once

#include <cmath>

#include "suite/linalg/tile_product.h"

namespace physinv::linalg {

/// a.b with four registers of partial sums.
inline double dot(Index n, const double* a, const double* b) {
  Pack8 s[4] = {};
  Index i = 0;
  for (; i + 4 * kWidth <= n; i += 4 * kWidth)
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k)
      s[k] =
          fma_lanes(load(a + i + k * kWidth), load(b + i + k * kWidth), s[k]);
  for (; i + kWidth <= n; i += kWidth)
    s[0] = fma_lanes(load(a + i), load(b + i), s[0]);
  double rest = 0;
  for (; i < n; ++i) rest = std::fma(a[i], b[i], rest);
  return sum_of((s[0] + s[1]) + (s[2] + s[3])) + rest;
}

// GCC 12 thinks up an overflow of i below where n is a constant.
#pragma GCC diagnostic push
#ifndef __clang__
#pragma GCC diagnostic ignored "-Waggressive-loop-optimizations"
#endif
/// y += s x.
inline void axpy(Index n, double s, const double* x, double* y) {
  const Pack8 factor = broadcast(s);
  Index i = 0;
  for (; i + kWidth <= n; i += kWidth)
    store(y + i, fma_lanes(factor, load(x + i), load(y + i)));
  for (; i < n; ++i) y[i] = std::fma(s, x[i], y[i]);
}
#pragma GCC diagnostic pop

/// x <- H x.
inline void turn(Index n, double tau, const double* v, double* x) {
  axpy(n, -tau * dot(n, v, x), v, x);
}
inline void turn(Index n, double tau, const double* v, Pack8* x) {
  Pack8 even{}, odd{};  // two sums hide the latency of one
  Index i = 0;
  for (; i + 2 <= n; i += 2) {
    even = even + v[i] * x[i];
    odd = odd + v[i + 1] * x[i + 1];
  }
  if (i < n) even = even + v[i] * x[i];
  const Pack8 along = -tau * (even + odd);
  for (i = 0; i < n; ++i) x[i] = x[i] + v[i] * along;
}

/// x (n) becomes v; H x = beta e1. tau = 0, H = I where x_1.. vanish. The
/// matrices are scaled to a largest entry near 1, so squares of what matters
/// neither overflow nor vanish.
inline double reflect(Index n, double* x, double& beta) {
  const double head = x[0];
  beta = head;
  x[0] = 1;
  const double tail = n > 1 ? dot(n - 1, x + 1, x + 1) : 0.0;
  if (!(tail > 0)) {
    for (Index i = 1; i < n; ++i) x[i] = 0;
    return 0;
  }
  beta = -std::copysign(std::sqrt(std::fma(head, head, tail)), head);
  const double scale = 1 / (head - beta);
  for (Index i = 1; i < n; ++i) x[i] *= scale;
  return (beta - head) / beta;
}

}  // namespace physinv::linalg
