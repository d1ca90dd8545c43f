/// What all wave packets of the JPO paper are solved with.
#pragma once

#include <vector>

#include "problems/wave_packet/wave_packet.h"
#include "suite/harness/registry.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::jpo::wave_packet {

inline constexpr nn::Grid kGrid{.columns = 256};

/// `unit`: so many samples are one.
inline ProblemRecipe recipe(double unit = WavePacketOptions{}.scale) {
  return problems::wave_packet({.scale = unit});
}

inline NetworkRole predictor(const std::vector<Index>& hidden) {
  return {{Field::observations},
          nn::vgg({.channels = 1,
                   .grid = kGrid,
                   .features = {16, 16, 16, 16, 16},
                   .hidden = hidden})};
}

inline Setting setting(const std::vector<Index>& hidden = {64, 32}) {
  return {
      .predictor = predictor(hidden),
      .surrogate = {{Field::unknowns, Field::given},
                    nn::unet(
                        {.grid = kGrid, .channels = 1, .scalars_before = 1})},
      .output_scale = 1.0,
      .gtol = 1e-5};
}

}  // namespace physinv::jpo::wave_packet
