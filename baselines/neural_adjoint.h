/// Neural adjoint (Ren, Padilla and Malof 2020; JPO paper, App. C): a network
/// N~ learns the forward process from labelled samples, then BFGS runs through
/// it instead of the physics,
///
///   L~_i(x) = 1/2 |N~(x, given_i) - y_i|^2 + w B(x),
///
/// with the boundary loss B of boundary_loss.h and w = 10 median_i of the
/// first term at the start, or a number. Bounded unknowns (Labelling) are
/// tanh x for the network and for B. The true loss is evaluated at every
/// accepted iterate, the start included; the best one is the estimate.
///
/// Stage `solve`, after the surrogate's `fit` (surrogate.h).
#pragma once

#include <memory>

#include "suite/core/method.h"

namespace physinv {

struct NeuralAdjointOptions {
  Index iterations = 300;   ///< of BFGS
  double gamma = 20;        ///< sharpness of the boundary's softplus
  double weight = 10;       ///< of the boundary, in median initial losses
  double fixed_weight = 0;  ///< w itself, if not 0

  auto fields() const {
    return std::tuple{word("algorithm", "neural_adjoint"),
                      field("gamma", gamma),
                      field("weight", weight),
                      if_changed(field("fixed_weight", fixed_weight)),
                      implied(iterations)};
  }
};

std::shared_ptr<const Stage> neural_adjoint_solve(
    const NeuralAdjointOptions& options = {});

}  // namespace physinv
