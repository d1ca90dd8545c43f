// What claims.md uses and formulas cannot express.
#include "suite/cases/common/claims.h"

#include <cmath>
#include <string>
#include <vector>

#include "suite/cases/hig/widths/widths.h"
#include "suite/core/math.h"
#include "suite/evidence/training.h"
#include "suite/harness/networks.h"

namespace physinv::hig::overview {
namespace {

/// Of the runs that are compared here.
Clock paper() {
  return paper_seconds([](const Run& run) -> std::string {
    const std::string& experiment = run.record->info.experiment;
    const bool hig = run.stage->arrays.contains("kept");
    if (experiment == "hig/oscillators")
      return hig ? "table3/hig/b=128/update" : "table3/adam/b=512/update";
    if (experiment == "hig/poisson")
      return hig ? "table4/hig/b=64/update" : "table4/adam/b=64/update";
    return hig ? "table5/hig/b=16/update" : "table5/adam/b=256/update";
  });
}

/// Of the first update of a stage.
std::optional<double> first_smallest(const Run& run) {
  const auto found = run.stage->arrays.find("smallest");
  if (found == run.stage->arrays.end() || found->second.size() == 0) return {};
  return found->second(0);
}

Quantity cpu_of_update(Index width) {
  return median(Select{"hig"}.in(widths::name_of(width)), seconds_per_update());
}

/// d log(time) / d log(parameters) from width to width, the largest.
Quantity steepest_growth() {
  std::vector<Quantity> all;
  for (std::size_t k = 1; k < widths::kWidths.size(); ++k) {
    const Index a = widths::kWidths[k - 1], b = widths::kWidths[k];
    const Quantity time = ratio(cpu_of_update(b), cpu_of_update(a)),
                   weights = ratio(parameters(widths::name_of(b)),
                                   parameters(widths::name_of(a)));
    all.push_back({[=](const Evidence& e) {
                     Measured m = time(e);
                     if (m.value)
                       *m.value =
                           math::log(*m.value) / math::log(*weights(e).value);
                     return m;
                   },
                   time.runs()});
  }
  return most(all);
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("paper", paper());
  names.set("first_smallest", first_smallest);
  names.add("cpu_of_update", cpu_of_update);
  names.add("steepest_growth", steepest_growth);
  r.add(Overview{
      .paper = "hig",
      .title = "Half-inverse gradients",
      .profiles = {"smoke", "quick", "standard", "paper"},
      .claims = claims_of_folder("hig/overview", names).front().claims});
}

}  // namespace physinv::hig::overview
