/// What all wave packets of the SIP paper are solved with.
#pragma once

#include <numbers>

#include "optimizers/training.h"
#include "problems/wave_packet/wave_packet.h"
#include "suite/cases/sip/wave_packet/metrics.h"
#include "suite/harness/registry.h"
#include "suite/nn/pooled_cnn.h"

namespace physinv::sip_wave_packet {

inline constexpr Index kExamples = 500, kBatch = 100;
inline constexpr AdamOptions kAdam{.rate = 1e-3, .eps = 1e-8};

/// The unknown is t0 - 76.8, in samples, of which line searches know nothing.
inline ProblemRecipe recipe(double width = 20) {
  return problems::wave_packet({.frequency = kFrequency,
                                .phase = -std::numbers::pi / 2,
                                .width = width,
                                .centre = 76.8,
                                .scale = 1,
                                .noise = 0.1,
                                .range = {25.6, 128},
                                .half_loss = false});
}

inline nn::PooledCnnOptions network() {
  return {.positions = 256,
          .features = {16, 16, 16, 16, 16},
          .hidden = {64, 32},
          .output = nn::Activation::half_tanh};
}

/// t0 = 76.8 + 51.2 tanh(z / 2) = 25.6 + 102.4 sigmoid(z)
inline Setting setting(const nn::PooledCnnOptions& net = network()) {
  return {.predictor = {{Field::observations}, nn::pooled_cnn(net)},
          .surrogate = {},
          .output_scale = 51.2};
}

inline Method trained(Index updates) {
  return {"net",
          {train({.rule = kAdam,
                  .batch = kBatch,
                  .iterations = updates,
                  .gradient_scale = double(kBatch),
                  .fresh = true,
                  .metrics = metrics()})}};
}

}  // namespace physinv::sip_wave_packet
