/// What claims about the quantum dipole are made of: runs by name, and how the
/// losses of the low (LE) and the high level (HE) fall.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "suite/cases/hig/quantum_dipole/grids.h"
#include "suite/cases/hig/quantum_dipole/metrics.h"
#include "suite/evidence/curve_shape.h"
#include "suite/evidence/options.h"
#include "suite/store/record.h"

namespace physinv::dipole {

// ---- runs -------------------------------------------------------------------

inline const Select kHig{"hig"}, kHigSlow{"hig-b16-eta025-tau5"},
    kHigFast{"hig-b16-eta10-tau5"}, kGn{"gn"}, kAdam{"adam"},
    kAdam3{"adam-b16-3e-4"}, kAdam10{"adam-b16-1e-3"}, kAdam30{"adam-b16-3e-3"},
    kAdam256{"adam-b256-5e-4"}, kTau2{"hig-b16-eta05-tau2"},
    kTau3{"hig-b16-eta05-tau3"}, kTau4{"hig-b16-eta05-tau4"},
    kTau6{"hig-b16-eta05-tau6"};
/// Fig. 4b's, as far as the text tells; its rates are not printed.
inline const std::vector<Select> kFig4Hig = {kHig, kHigSlow, kHigFast},
                                 kFig4Adam = {kAdam, kAdam3, kAdam10, kAdam30};

/// 90 minutes (from the authors' scripts) by the paper's clock.
inline constexpr double kEnd = 5400;

/// Table 5 begins at b = 256 for Adam; smaller batches are taken to last as
/// long, and convolutions as long as dense layers.
inline Clock paper() {
  return paper_seconds([](const Run& run) {
    const double batch = number_of(run.stage->options, "batch").value_or(16);
    const char* const row = run.stage->arrays.contains("kept")
                                ? (batch < 16 ? "hig/b=8" : "hig/b=16")
                            : batch > 512 ? "adam/b=1024"
                            : batch > 256 ? "adam/b=512"
                                          : "adam/b=256";
    return fmt::format("{} table5/{}/update", kDense, row);
  });
}

// ---- numbers ----------------------------------------------------------------

inline constexpr RowOfCurve kLowLoss = metric(kLow), kHighLoss = metric(kHigh);

/// Updates until HE < 0.1 over updates until LE < 0.1; empty without the first.
inline std::optional<double> lag(const Run& run) {
  const auto high = first_below(0.1, kHighLoss)(run),
             low = first_below(0.1, kLowLoss)(run);
  if (!high || !low || !std::isfinite(*high)) return {};
  return *high / *low;
}

/// Until HE < 0.1: the largest of f(LE, its lowest value so far).
template <class F>
inline std::optional<double> until_high(const Run& run, double level, F f) {
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
inline std::optional<double> rise(const Run& run) {
  return until_high(run, 1e300, [](double a, double b) { return a - b; });
}
/// The same as a ratio, once LE has been below 0.1.
inline std::optional<double> rise_ratio(const Run& run) {
  return until_high(run, 0.1, [](double a, double b) { return a / b; });
}

/// Updates to a test loss of 0.1 of runs as long as the slowest may take.
inline RunValue to_a_tenth(double count) {
  return if_ran(count, first_below(0.1));
}
inline Quantity over_hig(const Select& adam, double count) {
  return depends_on(
      most_stay_above(adam,
                      over(to_a_tenth(count), beside(kHig, to_a_tenth(224)))),
      {kHig});
}

}  // namespace physinv::dipole
