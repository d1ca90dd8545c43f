/// The problem's own loss as a LateError: what a training ends at on the
/// samples that it sees, whatever its signal. For problems that are given
/// nothing in addition to their unknowns.
#pragma once

#include "optimizers/training/signal_recipe.h"
#include "suite/core/recipe.h"

namespace physinv {

LateError late_loss(const ProblemRecipe& problem, double share = 0.25);

}  // namespace physinv
