/// What all billiards of the JPO paper are solved with.
#pragma once

#include "problems/billiards/billiards.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv::jpo::billiards {

inline ProblemRecipe recipe() { return problems::billiards(); }

inline Setting setting() {
  const auto network = nn::mlp({.hidden = {128, 128, 128}, .frequencies = 4});
  return {.predictor = {{Field::given, Field::observations}, network},
          .surrogate = {{Field::unknowns, Field::given}, network},
          .output_scale = 1.0,
          .gtol = 1e-5};
}

}  // namespace physinv::jpo::billiards
