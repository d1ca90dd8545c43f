/// What all Kuramoto-Sivashinsky equations of the JPO paper are solved with.
#pragma once

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/harness/registry.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::jpo::kuramoto_sivashinsky {

inline ProblemRecipe recipe() { return problems::kuramoto_sivashinsky(); }

inline Setting setting() {
  const nn::VggOptions predictor{.channels = 2,
                                 .grid = {.columns = 128},
                                 .features = {32, 32, 64, 64},
                                 .hidden = {64, 64}};
  return {
      .predictor = {{Field::given, Field::observations}, nn::vgg(predictor)},
      .surrogate = {{Field::given, Field::unknowns},
                    nn::unet({.grid = {.columns = 128},
                              .channels = 1,
                              .scalars_after = 2,
                              .scalar_shift = 1,
                              .scalar_unit = 0.25})},
      .output_scale = 0.25,
      .gtol = 1e-10};
}

}  // namespace physinv::jpo::kuramoto_sivashinsky
