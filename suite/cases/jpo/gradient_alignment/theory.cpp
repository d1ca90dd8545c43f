#include "suite/cases/jpo/gradient_alignment/theory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "suite/core/check.h"
#include "suite/core/math.h"

namespace physinv {
namespace {

double root(Index n) { return std::sqrt(static_cast<double>(n)); }

/// 1/2 + erf(sqrt(n) e / sqrt(factor (1/4 - e^2))) / 2.
double vote_normal(Index n, double snr, double factor) {
  const double e = 0.5 * math::erf(snr);
  const double variance = factor * (0.25 - e * e);
  if (!(variance > 0)) return e > 0 ? 1 : 0;
  return 0.5 + 0.5 * math::erf(root(n) * e / std::sqrt(variance));
}

}  // namespace

double align_single_sine(double lambda, double a) {
  if (lambda >= a) return 1;
  return 0.5 + math::asin(lambda / a) / std::numbers::pi;
}

double align_one(double snr) { return 0.5 + 0.5 * math::erf(snr); }

double align_one_first_order(double snr) {
  return 0.5 + snr * std::numbers::inv_sqrtpi;
}

double align_sum(Index n, double snr) { return align_one(snr * root(n)); }

double align_vote(Index n, double snr) {
  SUITE_CHECK(n > 0, "the number of votes must be positive");
  const double p = 0.5 * math::erfc(-snr), q = 0.5 * math::erfc(snr);
  if (q == 0) return 1;
  if (p == 0) return 0;
  const auto total = static_cast<double>(n);
  const double log_p = math::log(p), log_q = math::log(q);
  const auto term = [&](Index right) {
    const auto k = static_cast<double>(right);
    return math::exp(math::lgamma(total + 1) - math::lgamma(k + 1) -
                     math::lgamma(total - k + 1) + k * log_p +
                     (total - k) * log_q);
  };
  double sum = n % 2 == 0 ? 0.5 * term(n / 2) : 0;
  for (Index right = n / 2 + 1; right <= n; ++right) sum += term(right);
  return std::min(sum, 1.0);
}

double align_vote_normal(Index n, double snr) { return vote_normal(n, snr, 2); }

double align_vote_printed(Index n, double snr) {
  return vote_normal(n, snr, 1);
}

std::vector<double> response_curve(Index n, const Response& response) {
  SUITE_CHECK(n > 0 && response.plasticity > 0,
              "n and plasticity must be positive");
  std::vector<double> rho{1};
  rho.reserve(static_cast<std::size_t>(n));
  const double decay = math::exp(-1 / response.plasticity);
  double e = 1;
  for (Index i = 2; i <= n; ++i) {
    const auto N = static_cast<double>(i);
    const double last = rho.back();
    e *= decay;
    const double ratio = response.complexity / N;
    const double c = response.clamped ? std::min(1.0, ratio) : ratio;
    const double already = 0.5 * c + (1 - c) * last;
    rho.push_back(((N - 1) * last + (1 - e) * already + e) / N);
  }
  return rho;
}

double align_combined(double q, double rho) {
  return q * rho + (1 - q) * (1 - rho);
}

ResponseFit fit_response(std::span<const Index> sizes,
                         std::span<const double> measured) {
  SUITE_CHECK(!sizes.empty() && sizes.size() == measured.size(),
              "a measured value per size");
  constexpr double kStep = 0.25;
  const Index largest = *std::max_element(sizes.begin(), sizes.end());
  ResponseFit best{.rms = std::numeric_limits<double>::infinity()};
  for (int a = 1; a <= 120; ++a) {
    for (int c = 1; c <= 80; ++c) {
      const Response tried{.complexity = kStep * c, .plasticity = kStep * a};
      const auto rho = response_curve(largest, tried);
      double square = 0;
      for (std::size_t i = 0; i < sizes.size(); ++i) {
        const double r =
            rho[static_cast<std::size_t>(sizes[i] - 1)] - measured[i];
        square += r * r;
      }
      const double rms = std::sqrt(square / static_cast<double>(sizes.size()));
      if (rms < best.rms) best = {tried, rms};
    }
  }
  return best;
}

}  // namespace physinv
