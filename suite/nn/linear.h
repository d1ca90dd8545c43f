/// y = f(W x + b), f an activation taken in (see `fuse`).
///
/// Parameters: W [out][in] row-major, then b. Input rows that are constant
/// over the batch (`Replay::leading`, `trailing`) become one vector: the
/// bias is b + W_const x_const, and their weight gradient is
/// (sum over samples of y_bar) x_const^T. Only rounding differs.
#pragma once

#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
LayerPointer<T> linear(Index inputs, Index outputs);

}  // namespace physinv::nn
