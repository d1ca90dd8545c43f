#include "optimizers/half_inverse/power.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/linalg/eight.h"

namespace physinv::hig {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Standard deviations of a sum that one pair (i, j) may dominate.
constexpr double kSafety = 4;

/// s^exponent; the exponents of the half-inverse and of Gauss-Newton without
/// the general function.
double raised(double s, double exponent) {
  if (exponent == -1.5) return 1 / (s * std::sqrt(s));
  if (exponent == -2) return 1 / (s * s);
  return math::pow(s, exponent);
}

/// Kept and dropped directions, in units of lambda_max = s_max = 1.
struct Side {
  Eigen::ArrayXd lambda, s, f, c2;
  Eigen::ArrayXd tail;  ///< 1 from Spectrum::Noise::tail_begin on, else 0
};

/// In eight lanes: Eigen's own sum takes one number at a time.
double in_lanes(const Eigen::ArrayXd& terms) {
  using linalg::kWidth;
  linalg::Pack8 lanes = linalg::broadcast(0);
  Index i = 0;
  for (; i + kWidth <= terms.size(); i += kWidth)
    lanes += linalg::load(terms.data() + i);
  double rest = 0;
  for (; i < terms.size(); ++i) rest += terms(i);
  return sum_of(lanes) + rest;
}

/// |δ update|^2 to first order. A perturbation E of J J^T = diag(lambda) turns
/// f(J J^T) g by F_ij E_ij c_j, F the divided differences of
/// f = lambda^((kappa-1)/2) behind the cut, and the update by s_i times that:
///
///   sum_i s_i^2 sum_j F_ij^2 E_ij^2 c_j^2
///
/// for independent E_ij. Between kept values |F_ij| <= f(low) / high, as the
/// exponent of f lies in [-1, 0]; across the cut F_ij = f(kept) / distance.
double first_order(const Spectrum::Noise& noise,
                   double kappa,
                   double cut,
                   const Side& kept,
                   const Side& dropped) {
  // E_ij^2 of one i of a and all j of b.
  const auto entries2 = [&](const Side& a, Index i, const Side& b) {
    return (noise.gram + a.tail(i) * b.tail * (noise.tail - noise.gram) +
            noise.slope * (b.s + a.s(i)))
        .square();
  };
  Eigen::ArrayXd terms;
  double total = 0;
  const Index k = kept.s.size();
  for (Index j = 0; j < k; ++j) {
    const double lambda = kept.lambda(j), f = kept.f(j), c2 = kept.c2(j);
    if (kappa < 1) {
      terms = kept.lambda * entries2(kept, j, kept) *
              (kept.f.max(f) / kept.lambda.max(lambda)).square();
      total += c2 * in_lanes(terms);
    }
    terms = entries2(kept, j, dropped) /
            (lambda - dropped.lambda).square().max(entries2(kept, j, dropped)) *
            (dropped.s.square() * c2 + lambda * dropped.c2);
    total += f * f * in_lanes(terms);
  }
  // A value that may lie on the other side takes its component with it.
  const double f_cut = math::pow(cut, kappa - 1);
  for (const Side* side : {&kept, &dropped})
    for (Index i = 0; i < side->s.size(); ++i) {
      const double own = noise.entry(side->tail(i) > 0, side->s(i));
      if (std::abs(side->lambda(i) - cut * cut) > kSafety * own) continue;
      const double f = side == &kept ? side->f(i) : f_cut;
      total += cut * cut * f * f * side->c2(i);
    }
  return total;
}

/// Sizes of the weights.
struct Weighed {
  double square = 0;       ///< |update|^2
  double v2 = 0;           ///< |v|^2
  double s_kappa_max = 0;  ///< largest s^kappa that is kept
};

/// Fills the weights of what is kept, and the report's account of it.
Weighed weigh(const Spectrum& spectrum,
              const Power& power,
              double prefactor,
              PowerReport& report,
              VectorOut<double> weights) {
  Weighed sizes;
  weights.setZero();
  report.smallest_kept = kInfinity;
  report.margin = kInfinity;
  for (Index i = 0; i < spectrum.lambda.size(); ++i) {
    const double s = spectrum.s(i);
    if (report.cut > 0)
      report.margin =
          std::min(report.margin, std::abs(s - report.cut) / report.cut);
    if (!(s > report.cut)) {
      report.largest_dropped = std::max(report.largest_dropped, s);
      continue;
    }
    ++report.kept;
    report.smallest_kept = std::min(report.smallest_kept, s);
    const double w = prefactor * raised(s, power.kappa - 1);
    weights(i) = w * spectrum.c(i);
    sizes.square += s * weights(i) * (s * weights(i));
    sizes.v2 += weights(i) * weights(i);
    sizes.s_kappa_max = std::max(sizes.s_kappa_max, w * s);
  }
  return sizes;
}

/// Kept and dropped directions apart; false if a value that is kept could have
/// been made by noise: it is not proven to exist.
bool take_apart(const Spectrum& spectrum,
                double kappa,
                const PowerReport& report,
                Side& kept,
                Side& dropped) {
  const double top = report.s_max / spectrum.scale, lambda_max = top * top;
  const Spectrum::Noise& noise = spectrum.noise;
  const Index n = spectrum.lambda.size();
  for (Side* side : {&kept, &dropped}) {
    const Index size = side == &kept ? report.kept : n - report.kept;
    side->lambda.resize(size), side->s.resize(size), side->f.resize(size);
    side->c2.resize(size), side->tail.resize(size);
  }
  Index k = 0, d = 0;
  for (Index i = 0; i < n; ++i) {
    const bool tail = i >= noise.tail_begin;
    const double lambda = spectrum.lambda(i) / lambda_max;
    const double size =
        noise.norm_factor * noise.entry(tail, std::sqrt(std::max(lambda, 0.0)));
    Side& side = spectrum.s(i) > report.cut ? kept : dropped;
    Index& at = &side == &kept ? k : d;
    if (&side == &kept && lambda <= 2 * size) return false;
    side.lambda(at) = lambda;
    side.s(at) =
        std::sqrt(&side == &kept ? lambda : std::max(lambda, 0.0) + size);
    side.f(at) = raised(side.s(at), kappa - 1);
    side.c2(at) = spectrum.c(i) * spectrum.c(i);
    side.tail(at) = tail;
    ++at;
  }
  return true;
}

}  // namespace

double entry_noise(Index m, double matrix_noise) {
  const double solver = 0.75 * math::pow(static_cast<double>(m), 0.25);
  return kEpsilon * (matrix_noise + solver) / norm_factor(m);
}

double small_entry_noise(VectorIn<double> lambda,
                         double largest_diagonal,
                         double matrix_noise) {
  const double spread = lambda.norm() / static_cast<double>(lambda.size());
  return kEpsilon * ((4 + matrix_noise) * spread + 0.25 * largest_diagonal) /
         lambda.maxCoeff();
}

double norm_factor(Index m) { return 2 * std::sqrt(static_cast<double>(m)); }

double Spectrum::s(Index i) const {
  return scale * std::sqrt(std::max(lambda(i), 0.0));
}

double Spectrum::s_max() const {
  return lambda.size() == 0
             ? 0
             : scale * std::sqrt(std::max(lambda.maxCoeff(), 0.0));
}

PowerReport power_weights(const Spectrum& spectrum,
                          const Power& power,
                          VectorOut<double> weights) {
  SUITE_CHECK(std::abs(power.kappa) <= 1, "kappa must be in [-1, 1]");
  SUITE_CHECK(power.tau >= 0, "tau must not be negative");
  PowerReport report;
  report.s_max = spectrum.s_max();
  report.cut = power.cut(report.s_max);
  const double prefactor =
      power.beta == 0 ? 1 : math::pow(report.s_max, power.beta);
  const Weighed sizes = weigh(spectrum, power, prefactor, report, weights);
  if (report.kept == 0) {
    report.smallest_kept = 0;
    report.ending = Ending::zero;
    return report;
  }
  report.norm = std::sqrt(sizes.square);
  report.norm_bound = sizes.s_kappa_max * spectrum.c.norm();
  if (report.norm == 0) return report;

  Side kept, dropped;
  if (!take_apart(spectrum, power.kappa, report, kept, dropped)) {
    report.error = kInfinity;
    return report;
  }
  const double unit =
      report.norm / (prefactor * math::pow(report.s_max, power.kappa));
  const double leaked = first_order(
      spectrum.noise, power.kappa, report.cut / report.s_max, kept, dropped);
  // v itself, and J^T v, carry rounding of size eps s_max |v|.
  const double direct =
      kEpsilon * report.s_max * std::sqrt(sizes.v2) / report.norm;
  report.error = kSafety * (std::sqrt(leaked) / unit + direct);
  return report;
}

}  // namespace physinv::hig
