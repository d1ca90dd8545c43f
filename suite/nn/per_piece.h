/// The same layers on every piece of a field, a piece being some positions
/// that follow each other: for layers that look at one position at a time and
/// are much wider inside than at their ends. What runs between them stays in
/// the cache, and is made again in `backward` instead of being kept.
#pragma once

#include "suite/nn/layer.h"

namespace physinv::nn {

/// inner: layers one after the other, at least one, on one piece, without
/// state or tape slots. Their activations stay their own.
template <class T>
LayerPointer<T> per_piece(Index pieces, Layers<T> inner);

}  // namespace physinv::nn
