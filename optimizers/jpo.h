/// Joint parameterized optimization (JPO paper, Eq. 3): one network estimates
/// the unknowns of all problems of a batch and is trained on their own losses,
///
///   min_theta  sum_i L_i(x_start + scale N(given_i, y_i | theta)).
///
/// Every step clips each example's gradient dL_i/dx_i to the 90th percentile
/// of their norms, so that a grazing or chaotic example cannot drown the rest.
/// The result is the best estimate each example had at any iteration, the
/// state after the last step included.
///
/// Stage `fit`; a refinement (classical.h) composes with it. Arrays left:
/// `weight_change` (tensors x 1), mean |change| per tensor.
#pragma once

#include <memory>

#include "optimizers/steps/rule.h"
#include "suite/core/method.h"

namespace physinv {

struct JpoOptions {
  StepOptions step = AdamOptions{.rate = 1e-4};
  double clip = 0.9;  ///< quantile of the gradient norms
  Index iterations = 3000;

  auto fields() const {
    return std::tuple{word("algorithm", "jpo"),
                      field("clip", clip),
                      field("step", step),
                      implied(iterations)};
  }
};

std::shared_ptr<const Stage> jpo_fit(const JpoOptions& options = {});

}  // namespace physinv
