/// Smooth random fields on a periodic square: complex white noise per mode,
/// times 1 / (mx^2 + my^2), nothing where that sum is at most `cut`; the real
/// part of its inverse transform. All components together have mean 0 and the
/// given standard deviation.
#pragma once

#include <cmath>

#include "suite/core/batch.h"
#include "suite/core/rng.h"

namespace physinv::fluid {

struct NoiseOptions {
  Index cells = 64;
  Index components = 1;
  Index cut = 10;
  double deviation = 1;
};

/// `cut` of the papers' generator in a box of this size: its waves are shorter
/// than box / sqrt(10) in its own unit, 10.
inline Index noise_cut(double box) {
  return static_cast<Index>(std::floor(box * box / 1000));
}

/// Modes (component, kx, ky), ky fastest, in the order 0, 1, .., -1 of discrete
/// transforms; the field (component, i, j) likewise.
Vector<double> smooth_noise(const NoiseOptions& options,
                            VectorIn<double> real,
                            VectorIn<double> imaginary);

/// The same of normal numbers, real and imaginary parts in turn.
Vector<double> smooth_noise(const NoiseOptions& options, Stream& stream);

}  // namespace physinv::fluid
