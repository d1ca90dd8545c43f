/// The loss of a batch through the solver, y = F(x): its gradient
/// x_bar = J^T dLoss/dy, or the Jacobians themselves.
#pragma once

#include "optimizers/training/signal_recipe.h"

namespace physinv {

SignalRecipe solver_loss();

}  // namespace physinv
