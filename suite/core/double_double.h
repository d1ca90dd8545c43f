/// Numbers of twice the digits of a double: an unevaluated sum of two doubles,
/// high + low with high = round(high + low), by exact sums and products. The
/// same bits on every processor, which long double has not: 64 bits of mantissa
/// on x86-64, 113 on aarch64. The range is a double's; below 2^-970 digits are
/// lost. Not finite: high says so and low is 0.
///
/// u = 2^-53. Sums: Dekker 1971, Knuth, The Art of Computer Programming 2,
/// 4.2.2. Relative errors of + (3 u^2), * (4 u^2), / (10 u^2): M. Joldes, J.-M.
/// Muller, V. Popescu, ACM Trans. Math. Softw. 44 (2017), algorithms 6, 12, 17.
/// sqrt (4 u^2): V. Lefevre et al., ACM Trans. Math. Softw. 49 (2023).
#pragma once

#include <cmath>

namespace physinv {

struct DoubleDouble {
  double high = 0, low = 0;

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double x) : high(x) {}
  constexpr DoubleDouble(double h, double l) : high(h), low(l) {}

  /// The nearest double.
  explicit operator double() const { return high; }

  /// a + b, exactly.
  static DoubleDouble sum(double a, double b) {
    const double s = a + b, part = s - a;
    return {s, (a - (s - part)) + (b - part)};
  }
  /// a b, exactly.
  static DoubleDouble product(double a, double b) {
    const double p = a * b;
    return {p, std::fma(a, b, -p)};
  }
  /// h + l, where h is not the smaller one, as one of these.
  static DoubleDouble normal(double h, double l) {
    if (!std::isfinite(h)) return h;
    const double s = h + l;
    return {s, l - (s - h)};
  }

  friend DoubleDouble operator-(DoubleDouble a) { return {-a.high, -a.low}; }
  friend DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
    const DoubleDouble s = sum(a.high, b.high), t = sum(a.low, b.low);
    const DoubleDouble v = normal(s.high, s.low + t.high);
    return normal(v.high, t.low + v.low);
  }
  friend DoubleDouble operator-(DoubleDouble a, DoubleDouble b) {
    return a + -b;
  }
  friend DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
    const DoubleDouble p = product(a.high, b.high);
    const double inner = std::fma(a.high, b.low, a.low * b.low);
    return normal(p.high, p.low + std::fma(a.low, b.high, inner));
  }
  friend DoubleDouble operator/(DoubleDouble a, DoubleDouble b) {
    const double q = a.high / b.high;
    if (!std::isfinite(q) || !std::isfinite(b.high)) return q;
    const DoubleDouble p = b * q;
    const double rest = (a.high - p.high) + (a.low - p.low);
    return normal(q, rest / b.high);
  }
  DoubleDouble& operator+=(DoubleDouble b) { return *this = *this + b; }

  friend bool operator<(DoubleDouble a, DoubleDouble b) {
    return a.high < b.high || (a.high == b.high && a.low < b.low);
  }
  friend bool operator<=(DoubleDouble a, DoubleDouble b) {
    return a.high < b.high || (a.high == b.high && a.low <= b.low);
  }
};

inline DoubleDouble sqrt(DoubleDouble x) {
  const double root = std::sqrt(x.high);
  if (x.high == 0 || !std::isfinite(root)) return root;
  const double rest = std::fma(-root, root, x.high) + x.low;
  return DoubleDouble::normal(root, rest / (2 * root));
}

/// x 2^k
inline DoubleDouble ldexp(DoubleDouble x, int k) {
  return DoubleDouble::normal(std::ldexp(x.high, k), std::ldexp(x.low, k));
}

/// e^x = 2^k e^r, r = x - k ln 2 (Cody and Waite 1980), and the series of e^r
/// to r^27 / 27!, 2^-108 of it. Relative error below 2^-93; infinity and 0
/// where a double has no such number.
inline DoubleDouble exp(DoubleDouble x) {
  constexpr DoubleDouble kLn2(0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56);
  if (std::isnan(x.high)) return x.high;
  if (std::abs(x.high) > 746) return x.high > 0 ? HUGE_VAL : 0;
  const double k = std::nearbyint(x.high / kLn2.high);
  const DoubleDouble r = x - DoubleDouble(k) * kLn2;
  DoubleDouble series = 1;
  for (int n = 27; n > 0; --n) series = 1 + series * r / double(n);
  const int half = static_cast<int>(k) / 2;  // 2^k alone may overflow
  return ldexp(ldexp(series, half), static_cast<int>(k) - half);
}

struct SineCosine {
  DoubleDouble sine, cosine;
};

/// sin x and cos x for |x| < 2^30 (NaN beyond): those of r = x - k pi / 2 by
/// their series to r^29 / 29!. Absolute error below 2^-100 max(1, |x|).
inline SineCosine sine_cosine(DoubleDouble x) {
  constexpr double kHalfPi[] = {
      0x1.921fb54442d18p0, 0x1.1a62633145c07p-54, -0x1.f1976b7ed8fbcp-110};
  if (!(std::abs(x.high) < 0x1p30)) return {NAN, NAN};
  const double k = std::nearbyint(x.high / kHalfPi[0]);
  DoubleDouble r = x;
  for (const double part : kHalfPi) r = r - DoubleDouble::product(k, part);
  const DoubleDouble square = -(r * r);
  DoubleDouble s = 1, c = 1;
  for (int n = 28; n > 0; n -= 2) {
    s = 1 + s * square / double(n * (n + 1));
    c = 1 + c * square / double(n * (n - 1));
  }
  s = s * r;
  switch (static_cast<int>(std::fmod(k, 4) + 4) % 4) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

}  // namespace physinv
