/// What claims about the oscillators are made of: groups of runs, and losses
/// at equal updates or at equal time by the paper's clock, updates times the
/// seconds of Table 3.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "suite/cases/hig/oscillators/oscillators.h"
#include "suite/evidence/curve_shape.h"
#include "suite/store/record.h"

namespace physinv::oscillators {

using Ids = std::vector<std::string>;

inline const Clock kPaperClock = paper_seconds(update_row);
inline constexpr double kHigUpdate = 0.146, kHour = 3590;
inline constexpr double kThreeMinutes = 180;
inline constexpr double kFiveMinutes = 290;  ///< 2000 updates of HIG

// ---- numbers of a run -------------------------------------------------------

inline RunValue at_paper_time(double seconds) {
  return loss_at(kPaperClock, seconds);
}

/// Diverged, or at some point three times as high as at the start.
inline bool is_unstable(const Run& run) {
  return run.stage->stop == Stop::diverged ||
         *highest_loss()(run) > 3 * *first_loss()(run);
}
inline std::optional<double> unstable(const Run& run) {
  return is_unstable(run);
}

inline RunValue if_stable(RunValue value) {
  return [=](const Run& run) {
    return is_unstable(run) ? std::nullopt : value(run);
  };
}

// ---- of all seeds -----------------------------------------------------------

inline bool is_one(double v) { return v == 1; }

/// Medians at the same time by the paper's clock.
inline Quantity by_clock(const std::string& a,
                         const std::string& b,
                         double seconds) {
  return ratio_of_medians({a}, {b}, at_paper_time(seconds));
}

inline std::vector<Select> runs_of(const Ids& ids) {
  return each(ids, [](const auto& id) { return Select{id}; });
}

/// Highest over lowest median.
inline Quantity spread_of(const Ids& ids, const RunValue& value) {
  return spread_ratio(medians(runs_of(ids), value));
}

/// The same, infinite where a median diverged.
inline Quantity spread_or_unstable(const Ids& ids, const RunValue& value) {
  const Quantity highest = most(medians(runs_of(ids), value)),
                 spread = spread_of(ids, value);
  return {[=](const Evidence& e) {
            const Measured m = highest(e);
            return m.value && !std::isfinite(*m.value) ? m : spread(e);
          },
          spread.runs()};
}

inline Ids exponents(bool (*wanted)(double kappa)) {
  Ids ids;
  for (const Exponent& e : kExponents)
    if (wanted(e.kappa)) ids.emplace_back(e.id);
  return ids;
}
inline const Ids kOtherExponents =
                     exponents([](double k) { return k != -0.5; }),
                 kPositive = exponents([](double k) { return k > 0; }),
                 kNegative = exponents([](double k) { return k < 0; }),
                 kBetas = {"kappa-m05",
                           "beta-m125",
                           "beta-m250",
                           "beta-m375",
                           "beta-m500"};
inline const Ids kHigCuts = {
    "hig-tau5", "kappa-m05", "hig-tau7", "hig-tau8", "hig-tau9", "hig-tau10"};
inline const Ids kGnCuts = {
    "gn-tau5", "kappa-m1", "gn-tau7", "gn-tau8", "gn-tau9", "gn-tau10"};
inline const Ids kFirstOrder = {
    "sgd", "adagrad", "adadelta", "rmsprop", "adam"};
inline const Ids kAdamBatches = {"adam-b256", "adam", "adam-b1024"};

}  // namespace physinv::oscillators
