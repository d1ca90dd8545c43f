#include "optimizers/half_inverse/definite_solve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizers/half_inverse/spectral_power.h"
#include "suite/core/eigen_caches.h"

namespace physinv::hig {

using namespace linalg;
namespace {

constexpr int kRounds = 30;

/// Upper bound of the largest eigenvalue: the Frobenius norm.
double norm_bound(BatchIn<double> gram) {
  double total = 0;
  for (Index j = 0; j < gram.cols(); ++j) {
    const Index below = gram.rows() - j - 1;
    total +=
        gram(j, j) * gram(j, j) + 2 * gram.col(j).tail(below).squaredNorm();
  }
  return std::sqrt(total) * (1 + 1e-12);
}

using Cholesky = Eigen::LLT<Eigen::Ref<Batch<double>>>;

/// v = G^{-1} g by refinement: steps of the shifted matrix G - theta I, which
/// `cholesky` has, until the update's relative error in `report` is at most
/// `enough`. False where too many would be needed.
bool refine(const Cholesky& cholesky,
            BatchIn<double> gram,
            VectorIn<double> g,
            double enough,
            Vector<double>& residual,
            Vector<double>& step,
            VectorOut<double> v,
            PowerReport& report) {
  const auto full = gram.selfadjointView<Eigen::Lower>();
  v.setZero();
  residual = g;
  // |J^T G^{-1} r|^2 = r.G^{-1} r <= r.(G - theta I)^{-1} r, of the residual
  // that is left, against |update|^2 = v.G v.
  for (int round = 0;; ++round) {
    step = cholesky.solve(residual);
    const double left = std::max(residual.dot(step), 0.0);
    if (round > 0) report.error = std::sqrt(left) / report.norm;
    if (report.error <= enough && round > 0) return true;
    if (round == kRounds) return false;
    v += step;
    residual.noalias() = full * v;
    const double square = v.dot(residual);
    residual = g - residual;
    if (!(square > 0)) return false;
    report.norm = std::sqrt(square);
  }
}

}  // namespace

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
  state_caches();
  factor_ = gram.triangularView<Eigen::Lower>();
  factor_.diagonal().array() -= theta;
  began_ = true;
  const Cholesky cholesky(factor_);
  if (cholesky.info() != Eigen::Success) return false;

  report = PowerReport{};
  if (!refine(cholesky, gram, g, 1e-3 * tolerance, residual_, step_, v, report))
    return false;
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
