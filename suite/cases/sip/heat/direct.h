/// Heat without a network (Fig. 13): every example by itself, from zero.
///
/// Gradient descent with rate 1, and L-BFGS-B with memory 10, on the half
/// square. Both stay, in exact arithmetic, in the span of what the observation
/// has in each eigenspace of the diffusion, waves of one |k|. So the unknowns
/// may be one number per eigenspace, which is a rotation: every step has the
/// same length and loss. By `modes`, gradient descent is a closed form and
/// L-BFGS-B has 130 unknowns instead of 4096 (those with s <= 35, below which
/// gradients are rounding); by cells, all steps are made. The steps of the
/// local inverse are the same on spectra, where they need one transform of
/// four.
///
/// Arrays left: `mean_loss` (1 x points of the curve), `metrics`.
#pragma once

#include <memory>

#include "problems/heat/heat.h"
#include "suite/core/method.h"

namespace physinv::heat {

enum class Direct : std::uint8_t {
  descent,                ///< x -= P (P x - y*)
  descent_modes,          ///< the same at once
  lbfgsb_modes,           ///< see above
  inverse_physics,        ///< x += dx of the local inverse
  inverse_physics_modes,  ///< the same on spectra
};

struct DirectOptions {
  Direct solver = Direct::descent;
  Index iterations = 1000;
  /// What the local inverse takes for noise, instead of the problem's.
  double noise_floor = 1e-8;

  auto fields() const {
    return std::tuple{field("algorithm", solver),
                      field("noise_floor", noise_floor),
                      implied(iterations)};
  }
};

std::string_view to_string(Direct solver);

std::shared_ptr<const Stage> direct(const DirectOptions& options);

}  // namespace physinv::heat
