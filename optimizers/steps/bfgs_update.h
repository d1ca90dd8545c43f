/// The dense kernels of BFGS for one example: d x d matrices, column-major.
/// Summation orders are fixed and fused operations written out, so an example's
/// bits depend on nothing else.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "suite/core/simd/pack.h"

namespace physinv::dense {

inline void add_product(double& sum, double a, double b) {
  sum = std::fma(a, b, sum);
}

/// f(d), where two unknowns are a constant: loops over them vanish.
template <class F>
PHYSINV_LANES decltype(auto) of_size(Index d, F&& f) {
  return d == 2 ? f(std::integral_constant<Index, 2>{}) : f(d);
}

/// a[k].b[k] in four interleaved partial sums each, all at once: the sums of
/// one wait for each other.
template <std::size_t N>
inline std::array<double, N> dots(Index d,
                                  const std::array<const double*, N>& a,
                                  const std::array<const double*, N>& b) {
  using Four = Pack<double, 4>;
  std::array<Four, N> sums{};
  Index i = 0;
  for (; i + 4 <= d; i += 4)
#pragma GCC unroll 4
    for (std::size_t k = 0; k < N; ++k)
      sums[k] = fma_lanes(load<Four>(a[k] + i), load<Four>(b[k] + i), sums[k]);
  std::array<double, N> out;
#pragma GCC unroll 4
  for (std::size_t k = 0; k < N; ++k) {
    std::array<double, 4> lane;
    std::memcpy(lane.data(), &sums[k], sizeof(Four));
    for (Index j = i; j < d; ++j)
      add_product(lane[static_cast<std::size_t>(j - i)], a[k][j], b[k][j]);
    out[k] = (lane[0] + lane[1]) + (lane[2] + lane[3]);
  }
  return out;
}

/// a.b of two unknowns: the four sums of `dots`, two of them empty.
PHYSINV_LANES double dot_of_two(double a0, double a1, double b0, double b1) {
  return (std::fma(a0, b0, 0.0) + std::fma(a1, b1, 0.0)) + 0.0;
}

/// a.b, in the order of `dots`: the plain one for d <= 3.
PHYSINV_LANES double dot(Index d, const double* a, const double* b) {
  if (d != 2) return dots<1>(d, {a}, {b})[0];
  return dot_of_two(a[0], a[1], b[0], b[1]);
}

/// Largest magnitude; NaN entries are passed over.
inline double max_abs(Index d, const double* a) {
  double m = 0;
  for (Index i = 0; i < d; ++i) m = std::max(m, std::abs(a[i]));
  return m;
}

/// |a|; squares that overflow or vanish are summed again, scaled.
inline double norm(Index d, const double* a) {
  constexpr double kLost = 1e-280;
  const double square = dot(d, a, a);
  if (square > kLost && std::isfinite(square)) return std::sqrt(square);
  const double largest = max_abs(d, a);
  if (largest == 0 || !std::isfinite(largest)) return std::sqrt(square);
  int exponent;
  std::frexp(largest, &exponent);
  double sum = 0;
  for (Index i = 0; i < d; ++i) {
    const double part = std::ldexp(a[i], -exponent);
    add_product(sum, part, part);
  }
  return std::ldexp(std::sqrt(sum), exponent);
}

inline bool all_finite(Index d, const double* a) {
  bool finite = true;
  for (Index i = 0; i < d; ++i) finite &= std::isfinite(a[i]);
  return finite;
}

inline void set_identity(Index d, double* h) {
  std::fill(h, h + d * d, 0.0);
  for (Index i = 0; i < d; ++i) h[i * d + i] = 1;
}

/// out = H v.
inline void multiply(Index d, const double* h, const double* v, double* out) {
  of_size(d, [=](auto n) {
    std::fill(out, out + n, 0.0);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) add_product(out[i], h[j * n + i], v[j]);
  });
}

/// rho of the update; 1000 where y.s is exactly 0 (SciPy's value).
PHYSINV_LANES double curvature(double ys) { return ys == 0 ? 1000.0 : 1 / ys; }

/// bfgs_update of two unknowns, in registers: through memory, which may be that
/// of its other arguments, each number would wait for the one before.
inline void update_of_two(const double* s, const double* y, double* h) {
  const double s0 = s[0], s1 = s[1], y0 = y[0], y1 = y[1];
  const double rho = curvature(dot_of_two(y0, y1, s0, s1));
  const double u0 = std::fma(h[2], y1, std::fma(h[0], y0, 0.0));
  const double u1 = std::fma(h[3], y1, std::fma(h[1], y0, 0.0));
  const auto update = [=](double* column, double along) {
    const double right = rho * along;
    const double a = std::fma(u0, -right, column[0]);
    const double b = std::fma(u1, -right, column[1]);
    const double left = std::fma(-rho, dot_of_two(y0, y1, a, b), right);
    column[0] = std::fma(s0, left, a);
    column[1] = std::fma(s1, left, b);
  };
  update(h, s0);
  update(h + 2, s1);
}

/// H <- (I - rho s y^T) H (I - rho y s^T) + rho s s^T, with rho = 1 / (y.s). No
/// curvature safeguard.
///
/// Two rank-one steps, O(d^2). They round like the product of the three
/// matrices does; the expanded sum would cancel where H is much larger than
/// rho s s^T. `scratch` holds d numbers.
inline void bfgs_update(
    Index d, const double* s, const double* y, double* h, double* scratch) {
  if (d == 2) return update_of_two(s, y, h);
  const double rho = curvature(dot(d, y, s));
  double* u = scratch;
  multiply(d, h, y, u);
  for (Index j = 0; j < d; ++j) {
    double* column = h + j * d;
    const double right = rho * s[j];
    for (Index i = 0; i < d; ++i) add_product(column[i], u[i], -right);
    const double left = std::fma(-rho, dot(d, y, column), right);
    for (Index i = 0; i < d; ++i) add_product(column[i], s[i], left);
  }
}

}  // namespace physinv::dense
