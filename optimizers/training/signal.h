/// Training is signal x rule x batches (loop.h). A signal is what pushes the
/// network: the gradient of a loss through the solver, the distance from
/// labels, the distance from what an inverse solver proposes. It says so as a
/// gradient of the network's parameters, and, if it can, taken apart into the
/// Jacobians that half-inverse gradients need.
#pragma once

#include "optimizers/network_model.h"

namespace physinv {

/// The gradient of a batch, d objective / d outputs = sum_i S_i^T g_i.
template <class T>
struct Jacobians {
  /// Column i: S_i, observations by outputs of the network (observations x
  /// outputs, column-major).
  const Batch<T>& solver;
  const Batch<T>& g;  ///< column i: the gradient by sample i's observations
};

template <class T>
class Signal {
 public:
  virtual ~Signal() = default;

  /// Fills caches, before the clock starts; leaves no count behind.
  virtual void warm_up() {}

  /// Looks at the parameters as they stand, before a point of the curve is
  /// measured, for signals whose own passes are the estimates. No update
  /// follows the last look. False: there is nothing to learn from any more.
  virtual bool look([[maybe_unused]] bool last) { return true; }

  /// By the parameters, of the current batch's objective, in memory that may
  /// be written until the next call.
  virtual Vector<T>& gradient() = 0;

  /// The same at the last forward pass on the model's tape, taken apart.
  virtual Jacobians<T> jacobians();

  /// Adds arrays to what the stage leaves.
  virtual void leave(Outcome&) const {}
  virtual Counts counts() const { return {}; }
  virtual std::size_t bytes() const { return 0; }
};

template <class T>
Jacobians<T> Signal<T>::jacobians() {
  SUITE_CHECK(false, "this signal is not known by its Jacobians");
  static const Batch<T> none;
  return {none, none};
}

}  // namespace physinv
