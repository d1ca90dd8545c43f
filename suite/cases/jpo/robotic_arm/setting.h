/// What all robotic arms of the JPO paper are solved with.
#pragma once

#include "problems/robotic_arm/robotic_arm.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv::jpo::robotic_arm {

inline ProblemRecipe recipe() { return problems::robotic_arm(); }

inline Setting setting() {
  const auto network = nn::mlp({.hidden = {128, 128, 128}});
  return {.predictor = {{Field::observations}, network},
          .surrogate = {{Field::unknowns}, network},
          .output_scale = 1.0,
          .gtol = 1e-10};
}

}  // namespace physinv::jpo::robotic_arm
