/// Powers of the solver's own Jacobian S, without a network: each problem's
/// unknowns are what is learned (half-inverse gradients paper, Eq. 5, theta =
/// x),
///
///   x -= rate * s_max^beta S^(kappa, tau) g,   g = d loss / d y,
///
/// projected if the problem can. Problems are independent of each other. An
/// update that is not finite is not taken, and ends its problem with status
/// nonfinite.
///
/// Arrays left: `mean_loss` (1 x points of the curve, over the case's
/// problems), and what `metrics` adds, whose `parameters` are empty.
#pragma once

#include <memory>
#include <string>

#include "optimizers/half_inverse/power.h"
#include "optimizers/metrics.h"
#include "suite/core/method.h"

namespace physinv {

struct HalfInverseDirectOptions {
  std::string stage = "direct";
  hig::Power power = {};
  double rate = 1;
  Index iterations = 100;
  Metrics metrics = {};

  auto fields() const {
    return std::tuple{word("algorithm", "half_inverse_direct"),
                      field("power", power),
                      field("rate", rate),
                      field("metrics", metrics),
                      implied(stage, iterations)};
  }
};

std::shared_ptr<const Stage> half_inverse_direct(
    const HalfInverseDirectOptions& options);

}  // namespace physinv
