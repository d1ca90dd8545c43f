/// Training is signal x rule x batches (loop.h). A signal is what pushes the
/// network: the gradient of a loss through the solver, the distance from
/// labels, the distance from what an inverse solver proposes. It says so as a
/// gradient of the network's parameters, and, if it can, taken apart into the
/// Jacobians that half-inverse gradients need, or by products with second
/// derivatives.
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

  /// Evaluates the present parameters, before a point of the curve is measured,
  /// for signals whose own passes are the estimates. No update follows the last
  /// one. False: there is nothing to learn from any more.
  virtual bool evaluate([[maybe_unused]] bool last) { return true; }

  /// By the parameters, of the current batch's objective, in memory that may
  /// be written until the next call.
  virtual Vector<T>& gradient() = 0;

  /// The same at the last forward pass on the model's tape, taken apart.
  virtual Jacobians<T> jacobians();

  /// product = H direction at the last `gradient`, for any number of
  /// directions: H the objective's Hessian, or what is left of it (Gauss and
  /// Newton's matrix) without second derivatives of network and solver.
  virtual void hessian_product(const Vector<T>& direction, Vector<T>& product);
  virtual void gauss_newton_product(const Vector<T>& direction,
                                    Vector<T>& product);

  /// The current batch's objective at the model's parameters, nothing noted.
  /// The next products need a new gradient.
  virtual double objective();

  /// Between two updates: what later ones depend on, and what is left at the
  /// end; counts are kept by the loop.
  virtual void serialize(Archive& archive) = 0;
  /// Adds arrays to what the stage leaves.
  virtual void export_to(Outcome&) const {}
  virtual Counts counts() const { return {}; }
  virtual std::size_t bytes() const { return 0; }
};

template <class T>
Jacobians<T> Signal<T>::jacobians() {
  SUITE_CHECK(false, "this signal has no Jacobians");
  static const Batch<T> none;
  return {none, none};
}

template <class T>
void Signal<T>::hessian_product(const Vector<T>&, Vector<T>&) {
  SUITE_CHECK(false, "this signal has no products with its Hessian");
}

template <class T>
void Signal<T>::gauss_newton_product(const Vector<T>&, Vector<T>&) {
  SUITE_CHECK(false, "this signal has no Gauss-Newton products");
}

template <class T>
double Signal<T>::objective() {
  SUITE_CHECK(false, "this signal has no objective apart from its gradient");
  return 0;
}

}  // namespace physinv
