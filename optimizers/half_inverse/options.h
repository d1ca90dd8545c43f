/// How half-inverse gradients are set: a power of the Jacobian, how it is
/// computed, and the length of the step.
#pragma once

#include "optimizers/half_inverse/power.h"
#include "suite/core/options.h"

namespace physinv {
namespace hig {

struct HalfInverseOptions {
  /// What the estimate of an update's relative error (2-norm) may be; the
  /// error itself is 3 to 100 times smaller. 1e-6 is a strict mode.
  double tolerance = 3e-4;
  bool shortcut = true;
  double gram_noise = 1;  ///< see SpectralPower::factor
  /// Largest explicit Jacobian, in numbers; beyond it two levels are the end.
  Index largest_jacobian = 64'000'000;

  auto fields() const {
    return std::tuple{field("tolerance", tolerance),
                      if_changed(field("shortcut", shortcut)),
                      if_changed(field("gram_noise", gram_noise)),
                      if_changed(field("largest_jacobian", largest_jacobian))};
  }
};

}  // namespace hig

struct HalfInverseStepOptions {
  hig::Power power = {};
  double rate = 1;
  hig::HalfInverseOptions numerics = {};

  auto fields() const {
    return std::tuple{word("step", "half_inverse"),
                      field("power", power),
                      field("rate", rate),
                      field("numerics", numerics)};
  }
};

}  // namespace physinv
