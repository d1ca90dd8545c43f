/// The powers of the stacked Jacobian that App. C compares (Figs. 12, 13), and
/// batches that its figures may have been made with.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "optimizers/half_inverse/power.h"
#include "suite/cases/hig/oscillators/oscillators.h"
#include "suite/core/power_of_ten.h"

namespace physinv::oscillators {

struct AblationPoint {
  std::string id;  ///< of the method
  hig::Power power;
};

inline std::vector<AblationPoint> ablation_points() {
  std::vector<AblationPoint> all;
  for (const Exponent& e : kExponents)
    all.push_back({e.id, {.kappa = e.kappa, .tau = 1e-6}});
  for (const int digits : {5, 7, 8, 9, 10}) {
    const double tau = math::power_of_ten(-digits);
    all.push_back(
        {fmt::format("hig-tau{}", digits), {.kappa = -0.5, .tau = tau}});
    all.push_back({fmt::format("gn-tau{}", digits), {.kappa = -1, .tau = tau}});
  }
  for (const int thousandths : {125, 250, 375, 500})
    all.push_back(
        {fmt::format("beta-m{}", thousandths),
         {.kappa = -0.5, .tau = 1e-6, .beta = -thousandths / 1000.0}});
  return all;
}

/// Table 2 has 128 for Fig. 2b; the suite's figures have 64. A study for each;
/// tables of both are with the first one.
inline constexpr Index kAblationBatches[] = {128, 64};
inline std::string study_of(Index batch) {
  return fmt::format("studies/oscillators-batch-{}", batch);
}

}  // namespace physinv::oscillators
