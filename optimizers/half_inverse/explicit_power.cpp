#include "optimizers/half_inverse/explicit_power.h"

#include <algorithm>
#include <cmath>

#include "optimizers/half_inverse/units.h"
#include "suite/core/check.h"
#include "suite/core/eigen_caches.h"
#include "suite/core/unit_of.h"
#include "suite/linalg/decompositions.h"
#include "suite/linalg/householder.h"
#include "suite/linalg/pivoted_qr.h"

namespace physinv::hig {

using namespace linalg;
namespace {

/// Up to here Jacobi is as fast as bidiagonalisation, and more accurate.
constexpr Index kJacobi = 64;
constexpr int kSweeps = 60;
/// Squared norms below have lost digits to underflow; such columns count as 0.
constexpr double kNothing = 1e-280;

/// (a, b) <- (c a - s b, s a + c b)
void rotate(Index n, double c, double s, double* a, double* b) {
  const Pack8 cosine = broadcast(c), sine = broadcast(s);
  Index i = 0;
  for (; i + kWidth <= n; i += kWidth) {
    const Pack8 left = load(a + i), right = load(b + i);
    store(a + i, fma_lanes(cosine, left, -(sine * right)));
    store(b + i, fma_lanes(sine, left, cosine * right));
  }
  for (; i < n; ++i) {
    const double left = a[i], right = b[i];
    a[i] = std::fma(c, left, -(s * right));
    b[i] = std::fma(s, left, c * right);
  }
}

}  // namespace

bool orthogonalize_columns(BatchOut<double> x, VectorOut<double> h) {
  const Index n = x.cols();
  Vector<double> square(n);  // of the columns' norms
  const auto product = [&](Index p, Index q) {
    return dot(x.rows(), x.col(p).data(), x.col(q).data());
  };
  const auto note = [&](Index q) { square(q) = product(q, q); };
  for (Index q = 0; q < n; ++q) note(q);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    // Columns of nothing but rounding may never come closer than that.
    const double angle = kEpsilon * (2 * sweep < kSweeps ? 1.0 : double(n));
    bool turned = false;
    for (Index p = 0; p + 1 < n; ++p) {
      // The longest of the remaining columns comes first.
      Index longest = p;
      for (Index q = p + 1; q < n; ++q)
        if (square(q) > square(longest)) longest = q;
      if (longest != p) {
        x.col(p).swap(x.col(longest));
        std::swap(h(p), h(longest));
        std::swap(square(p), square(longest));
      }
      for (Index q = p + 1; q < n; ++q) {
        const double a = square(p), b = square(q);
        if (b < kNothing) continue;
        const double along = product(p, q);
        if (std::abs(along) <= angle * std::sqrt(a) * std::sqrt(b)) continue;
        turned = true;
        const double zeta = (b - a) / (2 * along);
        const double root = std::sqrt(std::fma(zeta, zeta, 1.0));
        const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + root);
        const double c = 1 / std::sqrt(1 + t * t), s = c * t;
        rotate(x.rows(), c, s, x.col(p).data(), x.col(q).data());
        note(p), note(q);
        const double left = h(p), right = h(q);
        h(p) = std::fma(c, left, -(s * right));
        h(q) = std::fma(s, left, c * right);
      }
    }
    if (!turned) return true;
  }
  return false;
}

bool ExplicitPower::decompose(Batch<double>& x, Vector<double>& h) {
  const Index n = x.cols();
  if (n > kJacobi) {
    SingularValues svd = singular_values(x);
    if (!svd.found) return false;
    spectrum_.lambda = svd.s.array().square();
    spectrum_.c = svd.v.transpose() * h;
    x.swap(svd.u);
    return true;
  }
  if (!orthogonalize_columns(x, h)) return false;
  spectrum_.c = h;
  for (Index i = 0; i < n; ++i) {
    const double s = x.col(i).stableNorm();
    spectrum_.lambda(i) = s * s;
    if (s > 0) x.col(i) /= s;
  }
  return true;
}

Ending ExplicitPower::factor(BatchIn<double> jacobian, VectorIn<double> g) {
  const Index m = jacobian.rows(), p = jacobian.cols(), n = std::min(m, p);
  SUITE_CHECK(n > 0 && g.size() == m, "g must have an entry for each row of J");
  spectrum_.lambda.setZero(n), spectrum_.c.setZero(n);
  spectrum_.scale = 1;
  state_caches();
  if (!g.allFinite() || !jacobian.allFinite())
    return ending_ = Ending::nonfinite;
  const double largest = jacobian.cwiseAbs().maxCoeff();
  if (largest == 0 || g.isZero(0)) return ending_ = Ending::zero;
  int exponent;
  std::frexp(largest, &exponent);
  exponent = std::clamp(exponent, -1022, 1022);  // what has an inverse
  spectrum_.scale = std::ldexp(1.0, exponent);
  const double unscale = std::ldexp(1.0, -exponent);

  // Tall: J P = Q R, h = Q^T g. Wide: J^T P = Q R, h = P^T g.
  const bool tall = m >= p;
  const PivotedQr qr(tall ? Batch<double>(jacobian * unscale)
                          : Batch<double>(jacobian.transpose() * unscale));
  Batch<double> h = g;
  if (tall) {
    qr.apply_q_transposed(h);
  } else {
    for (Index i = 0; i < n; ++i) h(i) = g(qr.order(i));
  }
  Vector<double> top = h.col(0).head(n);
  // Tall: R^T = V diag(s) U^T, c = U^T h. Wide: J = P R^T Q^T, so that with
  // R = V diag(s) U^T the same c, and the update is Q V.
  Batch<double> x = tall ? Batch<double>(qr.r().transpose()) : qr.r();
  if (!decompose(x, top)) return ending_ = Ending::stalled;
  right_.setZero(p, n);
  if (tall) {
    for (Index i = 0; i < n; ++i) right_.row(qr.order(i)) = x.row(i);
  } else {
    right_.topRows(n) = x;
    qr.apply_q(right_);
  }
  // Entries of the error of J against s_max, as in SpectralPower.
  spectrum_.noise = {.slope = entry_noise(n, 0),
                     .tail_begin = 0,
                     .norm_factor = norm_factor(n)};
  return ending_ = Ending::ok;
}

PowerReport ExplicitPower::apply(const Power& power,
                                 VectorOut<double> update) const {
  update.setZero();
  PowerReport report;
  report.ending = ending_;
  if (ending_ != Ending::ok) return report;
  Vector<double> w(spectrum_.c.size());
  const double unit = unit_of(spectrum_.scale);
  Spectrum scaled = spectrum_;
  scaled.scale /= unit;
  report = power_weights(scaled, in_units(power, unit), w);
  for (Index i = 0; i < w.size(); ++i) w(i) *= scaled.s(i);
  update.noalias() = right_ * w;
  leave_units(power, unit, report, update);
  return report;
}

}  // namespace physinv::hig
