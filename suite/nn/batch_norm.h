/// Batch normalisation of dense features (Ioffe and Szegedy 2015):
/// y = scale (x - mean) / sqrt(variance + 1e-5) + offset.
///
/// Training passes use the batch's mean and biased variance and need at least
/// two samples; other passes use the running ones. `update_state` moves the
/// running mean and (unbiased) variance a tenth of the way to the batch's.
/// Parameters: scale, offset. State: running mean, running variance.
#pragma once

#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
LayerPointer<T> batch_norm(Index features);

}  // namespace physinv::nn
