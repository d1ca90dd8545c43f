#include "optimizers/half_inverse/spectral_power.h"

#include <algorithm>
#include <cmath>

#include "suite/core/check.h"
#include "suite/core/simd/finite.h"
#include "suite/core/threads.h"
#include "suite/linalg/householder.h"

namespace physinv::hig {

using namespace linalg;

bool finite_lower(BatchIn<double> a, double& largest) {
  using V = Pack<double>;
  V most{};
  bool finite = true;
  for (Index j = 0; j < a.cols(); ++j) {
    const double* x = a.col(j).data() + j;
    finite = finite && all_finite(x, a.rows() - j);
    for_pieces<V>(a.rows() - j, [&](Index i, auto lanes) {
      const V size = abs_lanes(load_lanes<V>(x + i, lanes));
      most = select(size > most, size, most);
    });
  }
  largest = 0;
  for (int k = 0; k < kLanes<double>; ++k) largest = std::max(largest, most[k]);
  return finite;
}

Ending SpectralPower::factor(BatchIn<double> gram,
                             VectorIn<double> g,
                             double gram_noise,
                             Stages stages) {
  const Index m = g.size();
  SUITE_CHECK(m > 0 && gram.rows() == m && gram.cols() == m, "G is m x m");
  double largest = 0;
  spectrum_.lambda.setZero(m), spectrum_.c.setZero(m);
  spectrum_.scale = 1;
  const double top = g.cwiseAbs().maxCoeff();
  if (!g.allFinite() || !finite_lower(gram, largest))
    return ending_ = Ending::nonfinite;
  if (top == 0 || largest == 0) return ending_ = Ending::zero;

  // By a power of 4, so that s is scaled without rounding.
  int exponent;
  std::frexp(largest, &exponent);
  exponent = (exponent + (exponent > 0)) / 2;
  spectrum_.scale = std::ldexp(1.0, exponent);
  const double unscale = std::ldexp(1.0, -2 * exponent);

  const Symmetric a = reduction_.matrix(m);
  for (Index j = 0; j < m; ++j) {
    const double* from = gram.col(j).data();
    double* to = a.row(j);
    for (Index i = j; i < m; ++i) to[i] = from[i] * unscale;
  }
  u_.setZero(a.stride), gu_.setZero(a.stride);
  u_.head(m) = g / top;
  const double norm = u_.head(m).norm();
  const double alpha = -std::copysign(norm, u_(0));
  u_(0) -= alpha;
  u_.head(m) /= u_.head(m).norm();
  // G - u z^T - z u^T with z = 2 G u - 2 (u.G u) u.
  product_(a, 0, u_.data(), gu_.data(), threads_);
  gu_.tail(a.stride - m).setZero();
  const double along = u_.head(m).dot(gu_.head(m));
  gu_ = 2 * (gu_ - along * u_);
  for (Index j = 0; j < m; ++j) {
    double* row = a.row(j);
    const double uj = u_(j), zj = gu_(j);
    for (Index i = j; i < m; ++i) row[i] -= uj * gu_(i) + zj * u_(i);
  }
  reduction_.reduce(stages);

  spectrum_.lambda = reduction_.diagonal();
  e_ = reduction_.off_diagonal();
  spectrum_.c(0) = alpha * top;
  if (!qr_.run(spectrum_.lambda, e_, spectrum_.c))
    return ending_ = Ending::stalled;
  const double diagonal = gram.diagonal().maxCoeff() * unscale;
  spectrum_.noise = {
      .gram = small_entry_noise(spectrum_.lambda, diagonal, gram_noise),
      .slope = entry_noise(m, gram_noise),
      .tail_begin = m,
      .norm_factor = norm_factor(m)};
  return ending_ = Ending::ok;
}

PowerReport SpectralPower::apply(const Power& power,
                                 VectorOut<double> v,
                                 double most) const {
  v.setZero();
  if (ending_ != Ending::ok) return {.ending = ending_};
  const PowerReport report = power_weights(spectrum_, power, v);
  if (report.error > most) {
    v.setZero();
  } else if (report.kept > 0) {
    leave_eigenbasis(v);
  }
  return report;
}

void SpectralPower::leave_eigenbasis(VectorOut<double> v) const {
  qr_.apply(v.data());
  reduction_.apply(v.data());
  const auto u = u_.head(v.size());
  v -= (2 * u.dot(v)) * u;
}

void SpectralPower::directions(std::span<const Index> which,
                               BatchOut<double> out) const {
  const Index m = out.rows(), count = out.cols();
  const Index blocks = (count + kWidth - 1) / kWidth;
  for_blocks(threads_, blocks, [&](Index block, int) {
    const Index first = block * kWidth;
    std::vector<Pack8> x(static_cast<std::size_t>(m));
    Eigen::Map<Batch<double>> columns(
        reinterpret_cast<double*>(x.data()), kWidth, m);
    const Index here = std::min(kWidth, count - first);
    Index top = m;
    for (Index k = 0; k < here; ++k) {
      const Index row = which[static_cast<std::size_t>(first + k)];
      columns(k, row) = 1;
      top = std::min(top, row);
    }
    qr_.apply(x.data(), top);
    reduction_.apply(x.data());
    turn(m, 2, u_.data(), x.data());
    out.middleCols(first, here) = columns.topRows(here).transpose();
  });
}

}  // namespace physinv::hig
