/// Concepts of the inner loops: values and gradients are computed only when
/// asked for, and optimizers are tested on lambdas.
#pragma once

#include <concepts>
#include <span>

#include "suite/core/batch.h"

namespace physinv {

/// Losses and gradients of independent problems, in one batch. Column j of x
/// belongs to problem active[j]; loss and gradient are filled in that order.
///   f(active, x, loss, gradient)
template <class F>
concept BatchObjective = std::invocable<F&,
                                        std::span<const Index>,
                                        BatchIn<double>,
                                        VectorOut<double>,
                                        BatchOut<double>>;

/// Turns a gradient and its own state into a step: x is updated in place.
template <class U, class T>
concept UpdateRule = requires(U u, VectorOut<T> x, VectorIn<T> gradient) {
  u.step(x, gradient);
};

}  // namespace physinv
