/// The three products of a convolution on fields laid out position by
/// position (see window.h): rows = position * channels + channel, samples
/// along the lanes.
/// Nothing is gathered: the taps of a position along x are one block of
/// contiguous rows. A register tile spans outputs x columns, a column being a
/// vector of samples at one position, so that small batches fill a tile with
/// neighbouring positions. The weight gradient (conv_weights.h) has tiles of
/// whole vectors over samples.
///
/// Measured on one Zen 3 core, float, PHYSINV_NATIVE, GFlop/s with 8 and 128
/// samples, 128 positions, 16 -> 16 channels: 71 and 79; one `gemm` per
/// position 50 and 71; im2col and one `gemm` 28 and 33. At 256 positions,
/// 32 -> 16: 91 and 66 against 62 and 57, 28 and 14. (For comparison, Eigen's
/// best product: 52.) Weight gradient, 16 -> 16: 48 and 74.
///
/// Bits: `convolve` adds a sample's products one by one in the order of taps
/// and channels, by fused multiply-add, whatever tile it falls into. The
/// weight gradient's order follows from the shape and the number of samples.
#pragma once

#include <cstdint>
#include <vector>

#include "suite/nn/rows.h"
#include "suite/nn/window.h"

namespace physinv::nn {

struct ConvShape {
  Grid grid;              ///< of the output
  Index in = 1, out = 1;  ///< channels
  Taps taps;

  Index positions() const { return grid.positions(); }
  Index depth() const { return taps.count() * in; }
  Index weights() const { return out * depth(); }
  /// Of the input gradient.
  ConvShape flipped() const { return {grid, out, in, taps}; }
};

/// Weights [out][in][tap] in the order in which `convolve` reads them.
template <class T>
void pack_weights(const ConvShape& shape, const T* weights, T* packed);

/// The same for the input gradient, a convolution of the output's cotangent
/// with flipped taps and swapped channels.
template <class T>
void pack_flipped(const ConvShape& shape, const T* weights, T* packed);

/// Whether a product replaces its output or is added to it.
enum class Into : std::uint8_t { nothing, sum };

/// y[p][o] = bias[o] + sum over taps t and channels c of
/// w[o][c][t] x[p + t][c], for output positions [begin, end); into a sum, y in
/// place of the bias.
template <class T>
void convolve(const ConvShape& shape,
              const std::vector<WindowRun>& runs,
              const T* packed,
              const T* bias,  ///< or null for zero
              Rows<const T> x,
              Rows<T> y,
              Index begin,
              Index end,
              Into into = Into::nothing);

}  // namespace physinv::nn
