// What claims.md uses and formulas cannot express.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "problems/navier_stokes/navier_stokes.h"
#include "suite/cases/jpo/common/claim_names.h"
#include "suite/core/math.h"
#include "suite/evidence/statistics.h"

namespace physinv::jpo::navier_stokes {
namespace {

constexpr Index kLabels = 8;  ///< of each problem, as the experiment has them

/// Decades that the worst loss is above BFGS's worst.
std::optional<double> order_over_bfgs(const Run& run) {
  const auto ratio = over_bfgs(worst_loss())(run);
  return ratio ? std::optional(math::log10(*ratio)) : std::nullopt;
}

/// |slope| of the mean loss over log n, in twice its standard error.
Quantity slope_over_n(const Select& runs) {
  return {[=](const Evidence& e) {
            std::vector<double> x, y;
            for (const Run& run : find_runs(e, runs)) {
              x.push_back(math::log(static_cast<double>(run.n())));
              y.push_back(*mean_loss()(run));
            }
            const auto line = fit_line(x, y);
            if (!line) return missing(runs.text() + " not run");
            return Measured{
                .value = std::abs(line->slope) / (2 * line->slope_error),
                .runs = static_cast<Index>(x.size())};
          },
          {runs}};
}

/// Mean loss over BFGS's without the tenth of the problems (at least one) of
/// the highest loss.
std::optional<double> without_worst(const Run& run) {
  const auto other = bfgs_beside(run);
  if (!other) return {};
  const auto ours = losses()(run), theirs = losses()(*other);
  std::vector<std::size_t> order(ours.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return ours[a] < ours[b];
  });
  order.resize(order.size() - std::max<std::size_t>(1, order.size() / 10));
  double a = 0, b = 0;
  for (const std::size_t i : order) a += ours[i], b += theirs[i];
  return a / b;
}

/// 1 where a refined network ends at least 1 % below.
std::vector<double> stuck(const Run& run) {
  auto found = losses()(run);
  for (double& loss : found) loss *= 0.99;
  std::vector<double> flags(found.size(), 0);
  for (const Select& method : {kRefined, kSupervisedRefined, kAdjointRefined})
    if (const auto other = run.beside(method)) {
      const auto theirs = losses()(*other);
      for (std::size_t i = 0; i < flags.size(); ++i)
        if (theirs[i] <= found[i]) flags[i] = 1;
    }
  return flags;
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = jpo::claim_names();
  names.set("order_over_bfgs", order_over_bfgs);
  names.add("slope_over_n", slope_over_n);
  names.set("without_worst", without_worst);
  names.set("stuck", stuck);
  names.set("beyond_training",
            jpo::beyond_training(problems::navier_stokes(), 0, kLabels));
  names.set("better_in_band", better(Equality::band));
  names.set("equal_in_band", equal(Equality::band));
  names.add("table3_from_prior",
            [](Index seeds) { return table3(seeds, true); });
  add_claims_of_folder(r, "jpo/navier_stokes", names);
}

}  // namespace physinv::jpo::navier_stokes
