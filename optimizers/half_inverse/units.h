/// Powers of J = unit J', unit > 0, from those of J'.
#pragma once

#include "optimizers/half_inverse/power.h"
#include "suite/core/math.h"

namespace physinv::hig {

/// What is to be done with J'.
inline Power in_units(Power power, double unit) {
  if (power.absolute) power.tau /= unit;
  return power;
}

/// The update by J' and its report become those by J.
inline void leave_units(const Power& power,
                        double unit,
                        PowerReport& report,
                        VectorOut<double> update) {
  if (unit == 1) return;
  const double factor = math::pow(unit, power.kappa + power.beta);
  update *= factor;
  for (double* size : {&report.norm, &report.norm_bound}) *size *= factor;
  for (double* value : {&report.s_max,
                        &report.cut,
                        &report.smallest_kept,
                        &report.largest_dropped})
    *value *= unit;
}

}  // namespace physinv::hig
