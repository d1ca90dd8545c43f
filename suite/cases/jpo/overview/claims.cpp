// What claims.md uses and formulas cannot express.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "suite/cases/jpo/common/claim_names.h"
#include "suite/evidence/means.h"
#include "suite/harness/networks.h"

namespace physinv::jpo::overview {
namespace {

/// The tenth of its problems with JPO's highest losses (at least one) solved
/// by BFGS instead: mean loss over that without.
std::optional<double> falling_back(const Run& run) {
  const auto other = bfgs_beside(run);
  if (!other) return {};
  const auto jpo = losses()(run), classic = losses()(*other);
  std::vector<std::size_t> order(jpo.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return jpo[a] > jpo[b];
  });
  auto mixed = jpo;
  for (std::size_t k = 0; k < std::max<std::size_t>(1, order.size() / 10); ++k)
    mixed[order[k]] = classic[order[k]];
  return mean_of(mixed) / mean_of(jpo);
}

struct Main {
  const char *name, *title;
};
constexpr Main kMain[] = {{"jpo/wave-packet", "wave packet"},
                          {"jpo/billiards", "billiards"},
                          {"jpo/kuramoto-sivashinsky", "Kuramoto-Sivashinsky"},
                          {"jpo/navier-stokes", "Navier-Stokes"}};

/// In how many of the experiments, two at least, BFGS for a tenth lowers the
/// mean loss, by the four numbers. Missing if one is.
Condition bfgs_can_step_in() {
  const auto count = [](const std::vector<Measured>& all, const Evidence&) {
    Measured found{.value = 0};
    for (const Measured& one : all) {
      if (!one.value) return one;
      *found.value += *one.value < 1;
      found.runs += one.runs;
    }
    return found;
  };
  const auto parts = each(kMain, [](const Main& e) {
    return Quantity::Part{
        std::string("mean L with BFGS for a tenth, over without: ") + e.title,
        median(kRefined.in(e.name), falling_back)};
  });
  return at_least("experiments where BFGS for a tenth lowers the mean L",
                  Quantity::made_of(parts, count),
                  2);
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = jpo::claim_names();
  names.add("mean_of_all", mean_of_all);
  names.set("falling_back", falling_back);
  names.add("bfgs_can_step_in", bfgs_can_step_in);
  names.add("jpo_parameters", [](const std::string& of) {
    return parameters(of, &Setting::predictor);
  });
  names.add("surrogate_parameters", [](const std::string& of) {
    return parameters(of, &Setting::surrogate);
  });
  r.add(Overview{
      .paper = "jpo",
      .title = "Joint parameter optimization",
      .profiles = {"smoke", "quick", "paper"},
      .claims = claims_of_folder("jpo/overview", names).front().claims});
}

}  // namespace physinv::jpo::overview
