/// Skip connection: y = (x, inner(x)) along the channels, on rows laid out
/// position by position (see window.h). `inner` keeps the grid.
#pragma once

#include "suite/nn/layer.h"

namespace physinv::nn {

/// inner: layers one after the other, at least one. Their activations stay
/// their own.
template <class T>
LayerPointer<T> skip(Index positions, Layers<T> inner);

}  // namespace physinv::nn
