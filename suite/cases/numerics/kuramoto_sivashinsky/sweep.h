/// What is asked of the Kuramoto-Sivashinsky solver: step sizes, end times and
/// the axes of its stability sweeps.
#pragma once

#include <cmath>
#include <vector>

#include "suite/cases/numerics/common/accuracy.h"
#include "suite/cases/numerics/common/sweep_report.h"
#include "suite/evidence/runs.h"

namespace physinv::ks_numerics {

inline constexpr const char* kName = "numerics/kuramoto-sivashinsky";
inline constexpr double kEnd = 25;

inline std::vector<double> doubled(double first, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(std::ldexp(first, i));
  return out;
}

inline const SweepAxis kAlpha{"alpha", doubled(0.25, 13), true};
inline const SweepAxis kBeta{"beta", spaced(-6, 6, 25)};
inline const SweepAxis kLowBeta{"beta", spaced(0, 4, 9)};
inline const SweepAxis kTime{"end time", spaced(5, 100, 11)};

/// Steps, grid and samples per call.
const std::vector<NumericalParameter>& parameters();

/// Over the samples that have a number: the geometric mean of a column of an
/// array of the growth stage, or nothing.
std::optional<double> typical(const StageRecord& s,
                              ArrayKey array,
                              Index horizon);

}  // namespace physinv::ks_numerics
