#include "suite/evidence/rank_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "suite/core/math.h"

namespace physinv {
namespace {

/// Up to so many differences all signs are counted.
constexpr std::size_t kExact = 50;

struct Ranks {
  double below = 0, above = 0;     ///< sums over either sign
  double shared = 0;               ///< sum of t^3 - t over groups of equal size
  std::vector<std::size_t> twice;  ///< of each difference, twice its rank
};

/// `d` ascending in size.
Ranks ranks_of(const std::vector<double>& d) {
  Ranks sum;
  for (std::size_t k = 0; k < d.size();) {
    std::size_t end = k + 1;
    while (end < d.size() && std::abs(d[end]) == std::abs(d[k])) ++end;
    const double rank = 0.5 * static_cast<double>(k + 1 + end);
    const auto t = static_cast<double>(end - k);
    sum.shared += t * t * t - t;
    sum.twice.insert(sum.twice.end(), end - k, k + 1 + end);
    for (; k < end; ++k) (d[k] < 0 ? sum.below : sum.above) += rank;
  }
  return sum;
}

/// P(sum of the ranks of one sign <= that of these), every sign as likely.
double exact_tail(const Ranks& sum) {
  std::vector<double> ways(1, 1.0);  // of each twice a sum
  for (const std::size_t rank : sum.twice) {
    ways.resize(ways.size() + rank);
    for (std::size_t k = ways.size() - 1; k >= rank; --k)
      ways[k] += ways[k - rank];
  }
  const auto last = std::lround(2 * std::min(sum.below, sum.above));
  return std::ldexp(std::accumulate(ways.begin(), ways.begin() + last + 1, 0.0),
                    -static_cast<int>(sum.twice.size()));
}

double normal_p(double n, const Ranks& sum) {
  const double mean = n * (n + 1) / 4;
  const double variance = n * (n + 1) * (2 * n + 1) / 24 - sum.shared / 48;
  const double w = std::min(sum.below, sum.above);
  return math::erfc((mean - w) / std::sqrt(2 * variance));
}

}  // namespace

double decades_above(double a, double b) {
  const bool is_a = std::isfinite(a), is_b = std::isfinite(b);
  if (!is_a || !is_b) return is_a == is_b ? 0 : is_a ? -HUGE_VAL : HUGE_VAL;
  return math::log10(std::max(a, kEqualLoss)) -
         math::log10(std::max(b, kEqualLoss));
}

SignedRank signed_rank(std::span<const double> differences) {
  SignedRank out{.pairs = differences.size()};
  std::vector<double> d;
  for (const double value : differences) {
    out.below += value < 0;
    if (value != 0) d.push_back(value);
  }
  out.ties = out.pairs - d.size();
  if (d.empty()) return out;
  std::sort(d.begin(), d.end(), [](double a, double b) {
    return std::abs(a) < std::abs(b);
  });
  const Ranks sum = ranks_of(d);
  out.p = d.size() <= kExact ? 2 * exact_tail(sum)
                             : normal_p(static_cast<double>(d.size()), sum);
  out.p = std::min(out.p, 1.0);
  out.down = sum.below > sum.above;
  return out;
}

std::vector<double> holm(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(
      order.begin(), order.end(), [&](auto a, auto b) { return p[a] < p[b]; });
  std::vector<double> corrected(p.size());
  double highest = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto left = static_cast<double>(p.size() - k);
    highest = std::max(highest, std::min(1.0, left * p[order[k]]));
    corrected[order[k]] = highest;
  }
  return corrected;
}

std::string p_text(double p) {
  return p < 1e-6 ? "p < 1e-6" : fmt::format("p = {:.2g}", p);
}

}  // namespace physinv
