/// A rule makes an update of the network's parameters from a signal: from its
/// gradient (first_order.h), from its Jacobians (half_inverse_rule.h), from
/// products with second derivatives (adahessian_rule.h, hessian_free_rule.h).
#pragma once

#include "optimizers/training/signal.h"

namespace physinv {

template <class T>
class Rule {
 public:
  virtual ~Rule() = default;

  /// False if the update was not taken, and nothing changed.
  virtual bool operator()(Signal<T>& signal) = 0;

  /// What the next update depends on, and what is left at the end.
  virtual void serialize(Archive& archive) = 0;
  /// Adds arrays to what the stage leaves.
  virtual void export_to(Outcome&) const {}
  virtual std::size_t bytes() const = 0;
};

}  // namespace physinv
