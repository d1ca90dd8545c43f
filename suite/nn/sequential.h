/// Layers one after the other: the implementation of `Network`.
///
/// At construction an activation behind a layer that can take it in is fused
/// into that layer's store; its derivative is then multiplied in the store of
/// the next layer's input gradient. The tape holds each layer's output, once.
///
/// Parameters are drawn as `Init` says, in double, then rounded, each tensor
/// from the child of its own name.
///
/// Bits: without batch statistics and `Pass::fixed_input`, a sample's output
/// and input gradient depend on that sample alone, not on the batch it is in.
/// Nothing ever depends on the number of threads.
#pragma once

#include <memory>

#include "suite/core/network.h"
#include "suite/nn/layer.h"

namespace physinv::nn {

/// At least one layer; sizes must fit each other. It is a `RowJacobian`, too.
template <class T>
std::unique_ptr<Network<T>> sequential(Layers<T> layers,
                                       Init init = Init::fan_in);

}  // namespace physinv::nn
