/// Fourier neural operator: from a field on a plane to another one.
///
/// (value, row, column) -> width channels, by a linear layer; zeros added to
/// the ends of both axes up to grid + padding; four times z <- S z + W z + b
/// (spectral.h) with GELU between; on the grid again linear to `hidden`, GELU,
/// linear to 1. On 64 x 64: 1,188,353 parameters, a complex weight taken as
/// one, 2,368,001 real numbers. (Scale-invariant physics training, App. B.2.)
///
/// Spectral weights, real and imaginary, are drawn from U[0, 1) / width^2, the
/// others and all biases within +-1/sqrt(fan_in).
#pragma once

#include "suite/core/network.h"
#include "suite/nn/grid.h"

namespace physinv::nn {

struct FnoOptions {
  Grid grid;          ///< the row frequencies are those of both signs
  Index padding = 9;  ///< grid.columns + padding is at least 2 modes
  Index modes = 12, width = 32, blocks = 4, hidden = 128;

  auto fields() const {
    return std::tuple{word("grid", grid.text(), grid),
                      field("padding", padding),
                      field("modes", modes),
                      field("width", width),
                      field("blocks", blocks),
                      field("hidden", hidden)};
  }
};

NetworkRecipe fno(const FnoOptions& options);

}  // namespace physinv::nn
