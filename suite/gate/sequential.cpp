#include "suite/gate/sequential.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "suite/core/math.h"
#include "suite/core/median.h"

namespace physinv {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double log_evidence(double n, double above) {
  return n * math::log(2.0) - math::log(n + 1) - math::lgamma(n + 1) +
         math::lgamma(above + 1) + math::lgamma(n - above + 1);
}

Speed speed_of(const Decision& d, bool rejected, double margin) {
  if (-margin <= d.interval.low && d.interval.high <= margin)
    return Speed::equal;
  if (rejected && d.median > margin) return Speed::slower;
  if (rejected && d.median < -margin) return Speed::faster;
  return Speed::inconclusive;
}

}  // namespace

void MedianWatch::add(double number) {
  sorted_.insert(std::upper_bound(sorted_.begin(), sorted_.end(), number),
                 number);
  // A zero speaks for neither side: it counts for the weaker.
  const auto n = static_cast<double>(count());
  const auto above = static_cast<double>(
      sorted_.end() - std::upper_bound(sorted_.begin(), sorted_.end(), 0.0));
  const auto below = static_cast<double>(
      std::lower_bound(sorted_.begin(), sorted_.end(), 0.0) - sorted_.begin());
  const double more = std::max({above, below, n / 2});
  most_ = std::max(most_, log_evidence(n, more));
}

double MedianWatch::median() const {
  return sorted_.empty() ? 0 : physinv::median(sorted_);
}

double MedianWatch::p_value() const { return math::exp(-most_); }

Interval MedianWatch::interval(double alpha) const {
  const std::size_t n = count();
  std::size_t below = 0;  // numbers that the lower end leaves behind
  while (2 * below <= n &&
         log_evidence(static_cast<double>(n), static_cast<double>(n - below)) >=
             -math::log(alpha))
    ++below;
  if (below == 0) return {-kInfinity, kInfinity};
  return {sorted_[below - 1], sorted_[n - below]};
}

std::string_view to_string(Speed speed) {
  constexpr std::string_view names[] = {
      "slower", "faster", "equal", "inconclusive"};
  return names[static_cast<std::size_t>(speed)];
}

std::vector<Decision> decide(const std::vector<MedianWatch>& cases,
                             double alpha,
                             double margin) {
  std::vector<std::size_t> order(cases.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cases[a].p_value() < cases[b].p_value();
  });
  std::vector<Decision> all(cases.size());
  bool rejected = true;
  std::size_t left = cases.size();
  for (const std::size_t i : order) {
    Decision& d = all[i];
    d.alpha = alpha / static_cast<double>(left);
    rejected = rejected && cases[i].p_value() <= d.alpha;
    d.interval = cases[i].interval(d.alpha);
    d.median = cases[i].median();
    d.speed = speed_of(d, rejected, margin);
    if (rejected) --left;
  }
  return all;
}

}  // namespace physinv
