/// Max pooling and linear upsampling by 2 per axis, on rows laid out position
/// by position (see window.h).
#pragma once

#include "suite/nn/channel_norm.h"
#include "suite/nn/piecewise_linear.h"

namespace physinv::nn {

/// The largest of each cell; a tie's cotangent goes to the first. The last of
/// an odd number of columns or rows is in no cell.
template <class T>
LayerPointer<T> max_pool(Grid grid, Index channels);

/// Half-pixel centres, clamped ends; per axis of n inputs and m outputs, m = 2
/// n or 2 n + 1,
///
///   y[i] = (1 - w) v[j] + w v[j+1],  j + w = (i + 1/2) n / m - 1/2,  0 <= w <
///   1
///
/// and for m = 2 n
///
///   y[2i] = v[i-1] / 4 + 3 v[i] / 4,  y[2i+1] = 3 v[i] / 4 + v[i+1] / 4.
template <class T>
LayerPointer<T> upsample(Grid from, Grid to, Index channels);

}  // namespace physinv::nn
