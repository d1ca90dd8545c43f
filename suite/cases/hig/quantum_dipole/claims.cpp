// What claims.md uses and formulas cannot express.
#include "suite/cases/common/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "suite/cases/hig/quantum_dipole/grids.h"
#include "suite/cases/hig/quantum_dipole/metrics.h"
#include "suite/core/median.h"
#include "suite/evidence/curve_shape.h"
#include "suite/evidence/options.h"
#include "suite/evidence/training.h"
#include "suite/store/record.h"

namespace physinv::dipole {
namespace {

/// Table 5 begins at b = 256 for Adam; smaller batches are taken to last as
/// long, and convolutions as long as dense layers.
Clock paper() {
  return paper_seconds([](const Run& run) {
    const double batch = number_of(run.stage->options, "batch").value_or(16);
    const char* const printed_row = run.stage->arrays.contains("kept")
                                        ? (batch < 16 ? "hig/b=8" : "hig/b=16")
                                    : batch > 512 ? "adam/b=1024"
                                    : batch > 256 ? "adam/b=512"
                                                  : "adam/b=256";
    return fmt::format("{} table5/{}/update", kDense, printed_row);
  });
}

constexpr RowOfCurve kLowLoss = metric(kLow), kHighLoss = metric(kHigh);

/// Updates until HE < 0.1 over updates until LE < 0.1; empty without the first.
std::optional<double> lag(const Run& run) {
  const auto high = first_below(0.1, kHighLoss)(run),
             low = first_below(0.1, kLowLoss)(run);
  if (!high || !low || !std::isfinite(*high)) return {};
  return *high / *low;
}

/// Until HE < 0.1: the largest of f(LE, its lowest value so far).
template <class F>
std::optional<double> until_high(const Run& run, double level, F f) {
  const CurveRow low{*run.stage, "metrics", kLow},
      high{*run.stage, "metrics", kHigh};
  double lowest = std::numeric_limits<double>::infinity(), most = 0;
  for (Index k = 0; k < low.points(); ++k) {
    lowest = std::min(lowest, low(k));
    if (lowest < level) most = std::max(most, f(low(k), lowest));
    if (high(k) < 0.1) return most;
  }
  return {};
}
/// Largest rise of LE over its lowest value so far.
std::optional<double> rise(const Run& run) {
  return until_high(run, 1e300, [](double a, double b) { return a - b; });
}
/// The same as a ratio, once LE has been below 0.1.
std::optional<double> rise_ratio(const Run& run) {
  return until_high(run, 0.1, [](double a, double b) { return a / b; });
}

// ---- a control without a network --------------------------------------------

/// At the first measured point of so many updates or more.
template <class F>
RunValue at_update(Index updates, F value) {
  return [=](const Run& run) -> std::optional<double> {
    const StageRecord& s = *run.stage;
    for (Index k = 0; k < s.curve.points(); ++k)
      if (CurveRow{s}.updates(k) >= static_cast<double>(updates))
        return value(s, k);
    return {};
  };
}

RunValue value_at(RowOfCurve of, Index updates) {
  return at_update(updates, [of](const StageRecord& s, Index k) {
    return CurveRow{s, of.array, of.row}(k);
  });
}
/// Of the two named targets.
RunValue worse_named_at(Index updates) {
  return at_update(updates, [](const StageRecord& s, Index k) {
    return s.curve.loss.col(k).head(kNamed).maxCoeff();
  });
}
RunValue median_loss_at(Index updates) {
  return at_update(updates, [](const StageRecord& s, Index k) {
    const Vector<double> all = s.curve.loss.col(k);
    return median(std::vector<double>(all.begin(), all.end()));
  });
}
RunValue worst_loss_at(Index updates) {
  return at_update(updates, [](const StageRecord& s, Index k) {
    return s.curve.loss.col(k).maxCoeff();
  });
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("paper", paper());
  names.set("lag", lag);
  names.set("rise", rise);
  names.set("rise_ratio", rise_ratio);
  names.set("overlap", metric(kOverlap));
  names.set("rest", metric(kRest));
  names.add("value_at", value_at);
  names.add("worse_named_at", worse_named_at);
  names.add("median_loss_at", median_loss_at);
  names.add("worst_loss_at", worst_loss_at);
  add_claims_of_folder(r, "hig/quantum_dipole", names);
}

}  // namespace physinv::dipole
