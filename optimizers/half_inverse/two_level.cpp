#include "optimizers/half_inverse/two_level.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "optimizers/half_inverse/spectral_power.h"
#include "suite/core/check.h"

namespace physinv::hig {
namespace {

constexpr double kSecondLevel = 1e-4;  ///< of s_max

}  // namespace

Ending TwoLevelPower::factor(BatchIn<double> gram,
                             VectorIn<double> g,
                             Index parameters,
                             const Pullback& pullback,
                             double gram_noise) {
  const Index m = g.size();
  SUITE_CHECK(m > 0 && gram.rows() == m && gram.cols() == m, "G is m x m");
  spectrum_.lambda.setZero(m), spectrum_.c.setZero(m);
  double largest = 0;
  if (!g.allFinite() || !finite_lower(gram, largest))
    return ending_ = Ending::nonfinite;
  if (largest == 0 || g.isZero(0)) return ending_ = Ending::zero;

  int exponent;
  std::frexp(largest, &exponent);
  exponent = (exponent + (exponent > 0)) / 2;
  spectrum_.scale = std::ldexp(1.0, exponent);
  using Solver = Eigen::SelfAdjointEigenSolver<Batch<double>>;
  const Solver first(gram * std::ldexp(1.0, -2 * exponent));
  if (first.info() != Eigen::Success) return ending_ = Ending::stalled;
  // Eigen sorts upwards: the second level comes first, its end is k2.
  const auto& values = first.eigenvalues();
  const double top = values(m - 1);
  Index k2 = 0;
  while (k2 < m && !(values(k2) > kSecondLevel * kSecondLevel * top)) ++k2;
  const Index k1 = m - k2;
  u_.resize(m, m);
  u_.leftCols(k1) = first.eigenvectors().rightCols(k1);
  spectrum_.lambda.head(k1) = values.tail(k1);
  double tail = 0;
  if (k2 > 0) {
    const Batch<double> u2 = first.eigenvectors().leftCols(k2);
    Batch<double> w2(parameters, k2);
    pullback(u2, w2);
    if (!w2.allFinite()) return ending_ = Ending::nonfinite;
    w2 /= spectrum_.scale;
    Batch<double> square = Batch<double>::Zero(k2, k2);
    square.selfadjointView<Eigen::Lower>().rankUpdate(w2.transpose());
    const Solver second(square);
    if (second.info() != Eigen::Success) return ending_ = Ending::stalled;
    u_.rightCols(k2).noalias() = u2 * second.eigenvectors();
    spectrum_.lambda.tail(k2) = second.eigenvalues();
    tail = second.eigenvalues()(k2 - 1) / top;
  }
  spectrum_.c.noalias() = u_.transpose() * g;
  const double entry = entry_noise(m, gram_noise);
  spectrum_.noise = {.gram = entry,
                     .tail = entry * tail,
                     .jacobian = entry,  // rounding of W2
                     .tail_begin = k1,
                     .norm_factor = norm_factor(m)};
  return ending_ = Ending::ok;
}

PowerReport TwoLevelPower::apply(const Power& power,
                                 VectorOut<double> v) const {
  v.setZero();
  PowerReport report;
  report.ending = ending_;
  if (ending_ != Ending::ok) return report;
  Vector<double> w(v.size());
  report = power_weights(spectrum_, power, w);
  if (report.kept > 0) v.noalias() = u_ * w;
  return report;
}

}  // namespace physinv::hig
