/// Training on labels, without the physics: batches are labelled samples of the
/// training set, and the network is pushed to their solutions x*,
///
///   min_theta  sum_i 1/2 |x_i - x*_i|^2.
///
/// `batch_loss` is that of the labels.
#pragma once

#include "optimizers/training/signal_recipe.h"

namespace physinv {

SignalRecipe label_loss();

}  // namespace physinv
