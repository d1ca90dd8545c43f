/// What the chains of one method end with, over sizes and seeds: numbers for
/// claims about "every n and seed" or "all problems".
#pragma once

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include "suite/cases/jpo/common/claims.h"

namespace physinv {

/// One method's finished chains, refined or not, of n >= first.
class Endings {
 public:
  Endings(const JpoMetrics& metrics,
          std::string_view method,
          bool refined,
          Index first = 0);

  /// The largest (or smallest) value of any case.
  template <class F>
  std::optional<double> largest(F&& value) const {
    std::optional<double> out;
    for (const StageRecord* s : found_)
      out = std::max(out.value_or(value(*s)), value(*s));
    return out;
  }
  template <class F>
  std::optional<double> smallest(F&& value) const {
    const auto out = largest([&](const StageRecord& s) { return -value(s); });
    if (!out) return {};
    return -*out;
  }

  /// Of all problems: one row of the records, joined.
  std::vector<double> all(Vector<double> StageRecord::*row) const;

  /// Over all problems.
  std::optional<double> median_iterations() const;

 private:
  std::vector<const StageRecord*> found_;
};

double mean_loss(const StageRecord& s);
double median_loss(const StageRecord& s);

/// False for a campaign of profile smoke: it cuts training short, so claims
/// about what full training reaches mean nothing there.
bool full_training(const Results& results, std::string_view experiment);

}  // namespace physinv
