// What claims.md uses and formulas cannot express.
#include "suite/cases/common/claims.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "suite/cases/hig/oscillators/oscillators.h"
#include "suite/evidence/curve_shape.h"
#include "suite/store/record.h"

namespace physinv::oscillators {
namespace {

using Ids = std::vector<std::string>;

/// Diverged, or at some point three times as high as at the start.
bool is_unstable(const Run& run) {
  return run.stage->stop == Stop::diverged ||
         *highest_loss()(run) > 3 * *first_loss()(run);
}
std::optional<double> unstable(const Run& run) { return is_unstable(run); }

RunValue if_stable(RunValue value) {
  return [=](const Run& run) {
    return is_unstable(run) ? std::nullopt : value(run);
  };
}

std::vector<Select> runs_of(const Ids& ids) {
  return each(ids, [](const auto& id) { return Select{id}; });
}

/// Highest over lowest median, infinite where one diverged.
Quantity spread_or_unstable(const Ids& ids, const RunValue& value) {
  const auto all = medians(runs_of(ids), value);
  const Quantity highest = most(all), spread = spread_ratio(all);
  return {[=](const Evidence& e) {
            const Measured m = highest(e);
            return m.value && !std::isfinite(*m.value) ? m : spread(e);
          },
          spread.runs()};
}

/// P9: at the smallest rate the batch size matters little, at the largest the
/// loss jumps more.
std::vector<Condition> rates_and_batches() {
  std::vector<Condition> all;
  for (const Grid& grid : kGrids) {
    const auto ids = [&](double rate) {
      Ids some;
      for (const Index b : kGridBatches)
        some.push_back(grid_id(grid.rule, rate, b));
      return some;
    };
    const auto jumps = [&](double rate) {
      return most(medians(runs_of(ids(rate)), scatter()));
    };
    std::vector<Quantity> spreads;
    for (const double rate : grid.rates)
      spreads.push_back(spread_or_unstable(ids(rate), last_loss()));
    all.push_back(at_most(fmt::format("{}, highest over lowest b, at its "
                                      "most even rate",
                                      grid.rule),
                          least(spreads),
                          3.2));
    all.push_back(
        above(fmt::format("{}, scatter at the largest over the smallest rate, "
                          "infinite if it diverges",
                          grid.rule),
              ratio(jumps(grid.rates.back()), jumps(grid.rates.front())),
              1));
  }
  return all;
}

/// The spread of medians after so many updates, from `first` on.
Quantity highest_spread_along(const std::vector<Select>& runs, double first) {
  return highest_along(runs.at(0), first, [=](double updates) {
    return spread_ratio(medians(runs, loss_after(updates)));
  });
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("paper", paper_seconds(update_row));
  names.set("unstable", unstable);
  names.add("if_stable", if_stable);
  names.add("rates_and_batches", rates_and_batches);
  names.add("highest_spread_along", highest_spread_along);
  add_claims_of_folder(r, "hig/oscillators", names);
}

}  // namespace physinv::oscillators
