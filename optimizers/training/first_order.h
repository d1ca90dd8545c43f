/// Update rules that want nothing but the gradient.
#pragma once

#include "optimizers/steps/rule_check.h"
#include "optimizers/training/rule.h"

namespace physinv {

/// theta <- step(theta, gradient).
template <class T>
class FirstOrder : public Rule<T> {
 public:
  FirstOrder(const StepOptions& options, NetworkModel<T>& model)
      : model_(model), step_(options) {
    check_rule<T>(options);
  }

  bool operator()(Signal<T>& signal) override;
  void serialize(Archive& archive) override { step_.serialize(archive); }
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
