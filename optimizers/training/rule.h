/// A rule makes an update of the network's parameters from a signal: here the
/// first-order ones; half_inverse_rule.h has another.
#pragma once

#include "optimizers/steps/rule.h"
#include "optimizers/training/signal.h"

namespace physinv {

template <class T>
class Rule {
 public:
  virtual ~Rule() = default;

  /// False if the update was not taken, and nothing changed.
  virtual bool operator()(Signal<T>& signal) = 0;

  /// Adds arrays to what the stage leaves.
  virtual void leave(Outcome&) const {}
  virtual std::size_t bytes() const = 0;
};

/// theta <- step(theta, gradient).
template <class T>
class FirstOrder : public Rule<T> {
 public:
  FirstOrder(const StepOptions& options, NetworkModel<T>& model)
      : model_(model), step_(options) {}

  bool operator()(Signal<T>& signal) override;
  std::size_t bytes() const override;

 protected:
  NetworkModel<T>& model_;
  UpdateStep<T> step_;
};

/// The same, but no update that makes a parameter infinite or NaN.
template <class T>
class GuardedFirstOrder final : public FirstOrder<T> {
 public:
  using FirstOrder<T>::FirstOrder;
  bool operator()(Signal<T>& signal) override;
};

extern template class FirstOrder<float>;
extern template class FirstOrder<double>;
extern template class GuardedFirstOrder<float>;
extern template class GuardedFirstOrder<double>;

}  // namespace physinv
