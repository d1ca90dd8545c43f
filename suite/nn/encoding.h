/// Positional encoding: each scalar a becomes sin(a), ..., sin(K a), cos(a),
/// ..., cos(K a); scalars in order. K frequencies, 2 K features per scalar.
///
/// One sine and one cosine per scalar, the multiples by angle addition, in
/// double and then rounded: error below 2 K ulp of double.
#pragma once

#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
LayerPointer<T> positional_encoding(Index inputs, Index frequencies);

}  // namespace physinv::nn
