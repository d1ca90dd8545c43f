/// The network N~ that the neural adjoint (neural_adjoint.h) searches: it
/// learns the forward process from labelled samples.
///
/// Stage `fit`; its estimate is the start. Arrays left, in addition to a
/// regression's: `parameters`, `state`.
#pragma once

#include <memory>

#include "baselines/regression.h"

namespace physinv {

std::shared_ptr<const Stage> surrogate_fit(
    const RegressionOptions& options = {});

}  // namespace physinv
