/// Gradient descent with momentum (Polyak 1964), every problem by itself:
///
///   v = momentum v - rate g,  x = x + v
#pragma once

#include <memory>

#include "suite/core/method.h"

namespace pendulum {

using namespace physinv;

struct MomentumOptions {
  double rate = 0.02, momentum = 0.9;
  Index iterations = 200;

  auto fields() const {
    return std::tuple{word("algorithm", "momentum"),
                      field("rate", rate),
                      field("momentum", momentum),
                      implied(iterations)};
  }
};

/// Stage `solve`, from the experiment's start.
std::shared_ptr<const Stage> momentum_solve(
    const MomentumOptions& options = {});

}  // namespace pendulum
