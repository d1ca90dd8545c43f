/// What all flows of the JPO paper are solved with.
#pragma once

#include "optimizers/classical.h"
#include "problems/navier_stokes/navier_stokes.h"
#include "suite/harness/registry.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::jpo::navier_stokes {

/// The map has kinks everywhere: BFGS ends where it no longer gets on.
inline constexpr BfgsStageOptions kBfgs{
    .iterations = 100, .stall = 1e-5, .search_evaluations = 20};

/// `bounded`: so many unknowns pass through tanh.
inline ProblemRecipe recipe(Index bounded = 1) {
  return problems::navier_stokes({.bounded = bounded});
}

inline Setting setting() {
  const nn::VggOptions predictor{.channels = 2,
                                 .grid = {.columns = 32, .rows = 64},
                                 .features = {16, 32, 32, 32},
                                 .hidden = {64, 64}};
  // The flow below is hidden, before and after.
  const nn::UnetOptions surrogate{.grid = {.columns = 64, .rows = 64},
                                  .channels = 2,
                                  .scalars_after = 3,
                                  .outputs = 2,
                                  .hidden = 32};
  return {.predictor = {{Field::observations}, nn::vgg(predictor)},
          .surrogate = {{Field::given, Field::unknowns}, nn::unet(surrogate)},
          .gtol = 1e-3,
          .labels = {.per_problem = 8, .bounded = 1}};
}

}  // namespace physinv::jpo::navier_stokes
