/// A problem's forward pass as its paper writes it, in complex numbers of long
/// double: what rounding is measured against. Plain loops that share nothing
/// with the problem's kernels. Derivatives are taken by an imaginary step (no
/// difference, so no cancellation); comparisons look at real parts.
#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <span>

#include "suite/core/options.h"

namespace physinv {

using Exact = std::complex<long double>;

/// exp(z), for a real part below 11000 in size (0 and inf beyond), by sums and
/// products: the C library's takes an instruction, f2xm1, whose last bit hangs
/// on the processor. exp(r + k ln 2) = 2^k exp(r) (Cody and Waite 1980), the
/// series of exp(r) to r^20 / 20!, below 2^-70 of it.
inline Exact exact_exp(const Exact& z) {
  constexpr long double kHigh = 0xb17217f7d18p-44L,  // of ln 2: 41 bits
      kLow = 0x9ef35793c7673008p-105L, kLn2 = kHigh + kLow;
  const long double x = z.real();
  if (!(std::abs(x) <= 11000))
    return x < 0 ? 0 : x * std::numeric_limits<long double>::infinity();
  const long double k = std::nearbyint(x / kLn2);
  const long double r = x - k * kHigh - k * kLow;
  long double sum = 1;
  for (int n = 20; n > 0; --n) sum = 1 + sum * r / n;
  return std::ldexp(sum, static_cast<int>(k)) *
         Exact(std::cos(z.imag()), std::sin(z.imag()));
}

struct ClosedForm {
  /// y = F(x | given) of one sample.
  std::function<void(std::span<const Exact> x,
                     std::span<const double> given,
                     std::span<Exact> y)>
      forward;
  const char* source = __builtin_FILE();  ///< where it is written

  auto fields() const {
    return std::tuple{word("right", forward ? "closed form" : "", forward),
                      implied(source)};
  }
};

}  // namespace physinv
