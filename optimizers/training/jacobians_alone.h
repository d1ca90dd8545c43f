/// What half-inverse gradients are made of, and no gradient: a signal for
/// timing it.
#pragma once

#include "optimizers/training/signal_recipe.h"

namespace physinv {

/// Takes the Jacobians of the loss through the solver (solver_loss.h) and
/// leaves a gradient of zero: no weight moves.
SignalRecipe jacobians_alone();

}  // namespace physinv
