#include "optimizers/half_inverse/definite_solve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizers/half_inverse/spectral_power.h"
#include "suite/linalg/cholesky.h"
#include "suite/linalg/householder.h"

namespace physinv::hig {

using namespace linalg;
namespace {

constexpr int kRounds = 30;

/// Upper bound of the largest eigenvalue: the Frobenius norm.
double norm_bound(BatchIn<double> gram) {
  double total = 0;
  for (Index j = 0; j < gram.cols(); ++j) {
    const double* below = gram.col(j).data() + j + 1;
    total +=
        gram(j, j) * gram(j, j) + 2 * dot(gram.rows() - j - 1, below, below);
  }
  return std::sqrt(total) * (1 + 1e-12);
}

}  // namespace

Symmetric DefiniteSolve::padded(std::vector<double>& storage) {
  const Index stride = padded_stride(m_);
  storage.resize(static_cast<std::size_t>(m_ * stride));
  return {storage.data(), m_, stride};
}

/// v = G^{-1} g by refinement: steps of the shifted matrix G - theta I, which
/// was factored, until the update's relative error in `report` is at most
/// `enough`. False where too many would be needed.
bool DefiniteSolve::refine(VectorIn<double> g,
                           double enough,
                           VectorOut<double> v,
                           PowerReport& report) {
  const Symmetric gram = padded(gram_), factor = padded(factor_);
  const auto length = static_cast<std::size_t>(gram.stride);
  for (auto* x : {&v_, &product_, &residual_, &step_}) x->assign(length, 0.0);
  std::copy(g.data(), g.data() + m_, residual_.data());
  // |J^T G^{-1} r|^2 = r.G^{-1} r <= r.(G - theta I)^{-1} r, of the residual
  // that is left, against |update|^2 = v.G v.
  for (int round = 0;; ++round) {
    product_ = residual_;  // the solver overwrites it
    cholesky_solve(factor, product_.data(), step_.data());
    const double left = std::max(dot(m_, residual_.data(), step_.data()), 0.0);
    if (round > 0) report.error = std::sqrt(left) / report.norm;
    if (report.error <= enough && round > 0) break;
    if (round == kRounds) return false;
    for (Index i = 0; i < m_; ++i) v_[std::size_t(i)] += step_[std::size_t(i)];
    multiply_(gram, 0, v_.data(), product_.data(), nullptr);
    const double square = dot(m_, v_.data(), product_.data());
    for (Index i = 0; i < m_; ++i)
      residual_[std::size_t(i)] = g(i) - product_[std::size_t(i)];
    if (!(square > 0)) return false;
    report.norm = std::sqrt(square);
  }
  std::copy(v_.data(), v_.data() + m_, v.data());
  return true;
}

bool DefiniteSolve::operator()(BatchIn<double> gram,
                               VectorIn<double> g,
                               const Power& power,
                               double tolerance,
                               VectorOut<double> v,
                               PowerReport& report,
                               double gram_noise) {
  const Index m = g.size();
  began_ = false;
  if (power.kappa != -1 || power.beta != 0 || m == 0) return false;
  double largest = 0;
  if (!g.allFinite() || !finite_lower(gram, largest)) return false;
  if (g.isZero(0) || !(largest > 1e-140 && largest < 1e140)) return false;

  const double lambda_max = norm_bound(gram);
  const double s_max = std::sqrt(lambda_max);
  const double cut = power.cut(s_max);
  // A factorisation that runs to its end is that of a definite matrix up to
  // (m + 2) eps trace (Demmel; Higham, Accuracy and Stability, theorem 10.7).
  const double noise = kEpsilon * gram_noise * lambda_max;
  const double theta =
      cut * cut + noise +
      kEpsilon * static_cast<double>(m + 2) * gram.diagonal().sum();
  m_ = m;
  const Symmetric matrix = padded(gram_), factor = padded(factor_);
  for (Index r = 0; r < m; ++r) {
    double* const row = std::fill_n(matrix.row(r), r, 0.0);
    std::fill(std::copy_n(gram.col(r).data() + r, m - r, row),
              matrix.row(r) + matrix.stride,
              0.0);
  }
  factor_ = gram_;
  for (Index r = 0; r < m; ++r) factor.row(r)[r] -= theta;
  began_ = true;
  if (!cholesky(factor)) return false;

  report = PowerReport{};
  if (!refine(g, 1e-3 * tolerance, v, report)) return false;
  // G itself is known to `noise`: |delta update| <= noise |v| / (2 s_min).
  const double s_min = std::sqrt(theta);
  report.error +=
      kEpsilon * gram_noise * lambda_max * v.norm() / (s_min * report.norm);
  if (!(report.error <= tolerance)) return false;
  report.s_max = s_max;
  report.cut = cut;
  report.kept = m;
  report.smallest_kept = s_min;
  report.margin =
      cut > 0 ? s_min / cut - 1 : std::numeric_limits<double>::infinity();
  report.norm_bound = g.norm() / s_min;
  return true;
}

}  // namespace physinv::hig
