/// Wave packet localization: where in a noisy signal is the packet? (Joint
/// parameter optimization, Sec. 4, Fig. 3, App. D.1.)
///
///   u(t; t0) = A cos(w d + p) exp(-d^2 / (2 s^2)),  d = t - t0,
///   t = 1 .. samples,  t0 = centre + scale xi,  y = u + eps
///   du/dt0 = (w sin(w d + p) + cos(w d + p) d / s^2) A exp(-d^2 / (2 s^2))
///
/// Unknown x: xi (1). Given: an additive disturbance eps. Observation y: the
/// signal. `sample` hides its noise (given = 0), so that the loss of the truth
/// is the noise's and cannot become 0; `sample_labelled` shows it. Both draw
/// the same signals from the same stream.
///
/// xi is not bounded. A packet far from every sample is exactly 0: in double
/// where exp underflows (38.6 s), in float where the envelope is below 1e-17
/// (8.85 s). Such an xi has no gradient, and exactly the loss of no packet; in
/// double every xi has that loss once the packet no longer changes a bit of the
/// target. Samples that are not computed are counted as `skipped_zeros`.
///
/// vjp, Jacobian: exact. Errors below 1e-13 A in double, 1e-6 A in float. An
/// xi that is not finite gives NaN in its own column only.
#pragma once

#include <array>
#include <vector>

#include "suite/core/recipe.h"

namespace physinv {

struct WavePacketOptions {
  Index samples = 256;     ///< length of the signal, a multiple of 64
  double amplitude = 1.0;  ///< A
  double frequency = 1.0;  ///< w, radians per sample
  double phase = 0.0;      ///< p; -pi / 2 makes a sine of the cosine
  double width = 20.0;     ///< s, samples, at least 1
  double centre = 128.0;   ///< t0 at xi = 0
  double scale = 128.0;    ///< samples per unit of xi
  double noise = 0.1;      ///< standard deviation of eps
  std::array<double, 2> range = {26.0, 230.0};  ///< of the true t0, uniform
  bool half_loss = true;  ///< half the squared error, or all of it

  auto fields() const {
    return std::tuple{field("samples", samples),
                      field("amplitude", amplitude),
                      field("frequency", frequency),
                      field("phase", phase),
                      field("width", width),
                      field("centre", centre),
                      field("scale", scale),
                      field("noise", noise),
                      field("range", range),
                      field("half_loss", half_loss)};
  }
};

namespace problems {
ProblemRecipe wave_packet(const WavePacketOptions& options = {});
}

}  // namespace physinv
