#include "suite/cases/hig/quantum_dipole/runs.h"

#include <algorithm>
#include <limits>

#include "suite/cases/hig/common/report.h"
#include "suite/cases/hig/quantum_dipole/metrics.h"
#include "suite/cases/jpo/common/endings.h"
#include "suite/evidence/curve.h"

namespace physinv::dipole {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

CurveRow low(const StageRecord& s) { return {s, "metrics", kLow}; }
CurveRow high(const StageRecord& s) { return {s, "metrics", kHigh}; }

/// Updates until the first point below `level`; infinite if there is none.
double until_below(const CurveRow& values, double level) {
  for (Index k = 0; k < values.points(); ++k)
    if (values(k) < level) return values.updates(k);
  return kInfinite;
}

}  // namespace

Value loss_after(double updates) {
  return [=](const StageRecord& s) { return loss_at(s, updates); };
}

Value if_long(double enough, const Value& value) {
  return [=](const StageRecord& s) -> std::optional<double> {
    if (s.curve.iteration.back() < enough) return {};
    return value(s);
  };
}

Value until(double level, double enough) {
  return if_long(enough, [=](const StageRecord& s) {
    return until_below(CurveRow{s}, level);
  });
}

std::optional<double> stalled(const StageRecord& s) {
  const CurveRow loss{s};
  double longest = 0, from = -1;
  for (Index k = 0; k < loss.points(); ++k) {
    const bool inside = loss(k) >= 0.4 && loss(k) <= 0.56;
    if (!inside) from = -1;
    if (inside && from < 0) from = loss.updates(k);
    if (inside) longest = std::max(longest, loss.updates(k) - from);
  }
  return longest;
}

std::optional<double> lag(const StageRecord& s) {
  const double he = until_below(high(s), 0.1), le = until_below(low(s), 0.1);
  if (he == kInfinite) return {};
  return he / le;
}

std::optional<double> rise(const StageRecord& s) {
  double lowest = kInfinite, most = 0;
  for (Index k = 0; k < low(s).points(); ++k) {
    lowest = std::min(lowest, low(s)(k));
    most = std::max(most, low(s)(k) - lowest);
    if (high(s)(k) < 0.1) return most;
  }
  return {};
}

Value settled(double enough) {
  return [=](const StageRecord& s) -> std::optional<double> {
    const CurveRow loss{s};
    const Index last = loss.points() - 1;
    if (last < 2 || loss.updates(last) < enough) return {};
    return median({loss(last), loss(last - 1), loss(last - 2)});
  };
}

Seeds::Seeds(const Results& results,
             std::string_view method,
             const Value& value,
             const char* experiment) {
  for (const std::uint64_t seed : results.seeds(experiment))
    if (const auto* s = trained_stage(results, experiment, method, seed))
      if (const auto v = value(*s)) values_[seed] = *v;
}

std::optional<double> Seeds::middle() const {
  if (!any()) return {};
  return median(sorted());
}

std::optional<double> Seeds::smallest_ratio(const Seeds& other) const {
  std::optional<double> least;
  for (const auto& [seed, v] : values_) {
    const auto pair = other.values_.find(seed);
    if (pair != other.values_.end())
      least = std::min(least.value_or(kInfinite), v / pair->second);
  }
  return least;
}

std::vector<double> Seeds::sorted() const {
  std::vector<double> all;
  for (const auto& [seed, v] : values_) all.push_back(v);
  std::sort(all.begin(), all.end());
  return all;
}

std::optional<double> Seeds::ranked(Index i) const {
  if (!any()) return {};
  return sorted()[static_cast<std::size_t>(i)];
}

}  // namespace physinv::dipole
