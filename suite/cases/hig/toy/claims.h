/// The toy fit for several gamma, and what its figure claims about them.
#pragma once

#include <array>
#include <vector>

#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv::toy {

struct Gamma {
  double value;
  const char *experiment, *title;
};

inline constexpr std::array<Gamma, 3> kGammas = {
    {{1, "hig/toy-gamma-1", "Scaled output, gamma = 1"},
     {0.1, "hig/toy-gamma-0p1", "Scaled output, gamma = 0.1"},
     {0.01, "hig/toy-gamma-0p01", "Scaled output, gamma = 0.01"}}};

/// Those that belong to this gamma; A5 and A6 are judged for 1 and 0.01 each.
std::vector<ClaimResult> claims(const Gamma& gamma, const Results& results);

}  // namespace physinv::toy
