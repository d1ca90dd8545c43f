/// How Hessian-free optimization (hessian_free_rule.h) is set.
#pragma once

#include "optimizers/training/conjugate_gradients.h"
#include "suite/core/options.h"

namespace physinv {

struct HessianFreeOptions {
  double rate = 1;     ///< of the update
  double damping = 1;  ///< to begin with
  double warm = 0.95;  ///< share of the last result to start from
  ConjugateGradientOptions solver = {};

  auto fields() const {
    return std::tuple{word("step", "hessian_free"),
                      field("rate", rate),
                      field("damping", damping),
                      field("warm", warm),
                      field("solver", solver)};
  }
};

}  // namespace physinv
