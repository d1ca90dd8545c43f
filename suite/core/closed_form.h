/// A problem's forward pass as its paper writes it, in numbers of twice the
/// digits of a double: what rounding is measured against. Plain loops that
/// share nothing with the problem's kernels. A number carries its derivative
/// along (forward mode), so that nothing cancels; comparisons look at values.
#pragma once

#include <functional>
#include <span>

#include "suite/core/double_double.h"
#include "suite/core/options.h"

namespace physinv {

/// A value and its derivative by the one input that moves.
struct Exact {
  DoubleDouble value, slope;

  Exact() = default;
  Exact(double v) : value(v) {}
  Exact(DoubleDouble v, DoubleDouble s = {}) : value(v), slope(s) {}

  friend Exact operator-(Exact a) { return {-a.value, -a.slope}; }
  friend Exact operator+(Exact a, Exact b) {
    return {a.value + b.value, a.slope + b.slope};
  }
  friend Exact operator-(Exact a, Exact b) { return a + -b; }
  friend Exact operator*(Exact a, Exact b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  friend Exact operator*(DoubleDouble a, Exact b) {
    return {a * b.value, a * b.slope};
  }
  friend Exact operator*(double a, Exact b) { return DoubleDouble(a) * b; }
  friend Exact operator/(Exact a, Exact b) {
    const DoubleDouble q = a.value / b.value;
    return {q, (a.slope - q * b.slope) / b.value};
  }
  Exact& operator+=(Exact b) { return *this = *this + b; }
  Exact& operator-=(Exact b) { return *this = *this - b; }
};

inline Exact sqrt(Exact x) {
  const DoubleDouble root = sqrt(x.value);
  return {root, x.slope / (2 * root)};
}
inline Exact exp(Exact x) {
  const DoubleDouble e = exp(x.value);
  return {e, e * x.slope};
}
inline Exact sin(Exact x) {
  const auto [s, c] = sine_cosine(x.value);
  return {s, c * x.slope};
}
inline Exact cos(Exact x) {
  const auto [s, c] = sine_cosine(x.value);
  return {c, -s * x.slope};
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
