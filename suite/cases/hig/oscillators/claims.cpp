// What claims.md asks for that is no formula.
#include "suite/cases/common/claims.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "suite/cases/hig/oscillators/quantities.h"

namespace physinv::oscillators {
namespace {

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
  names.set("paper", kPaperClock);
  names.set("unstable", unstable);
  names.add("if_stable", if_stable);
  names.add("rates_and_batches", rates_and_batches);
  names.add("highest_spread_along", highest_spread_along);
  add_claims_of_folder(r, "hig/oscillators", names);
}

}  // namespace physinv::oscillators
