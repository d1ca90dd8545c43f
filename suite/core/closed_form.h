/// A problem's forward pass as its paper writes it, in complex numbers of long
/// double: what rounding is measured against. Plain loops that share nothing
/// with the problem's kernels. Derivatives are taken by an imaginary step (no
/// difference, so no cancellation); comparisons look at real parts.
#pragma once

#include <complex>
#include <functional>
#include <span>

#include "suite/core/options.h"

namespace physinv {

using Exact = std::complex<long double>;

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
