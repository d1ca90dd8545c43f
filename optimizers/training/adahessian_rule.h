/// AdaHessian (steps/adahessian.h) as a rule. The signs of update i are drawn
/// from child i of the method's stream "probes".
#pragma once

#include "optimizers/steps/adahessian.h"
#include "optimizers/training/rule.h"

namespace physinv {

template <class T>
class AdaHessianRule final : public Rule<T> {
 public:
  AdaHessianRule(const AdaHessianOptions& options,
                 NetworkModel<T>& model,
                 const Rng& method)
      : model_(model),
        step_(options, model.network().tensors()),
        probes_(method.child("probes")) {}

  bool operator()(Signal<T>& signal) override;
  void serialize(Archive& archive) override { archive(step_, updates_); }
  std::size_t bytes() const override;

 private:
  NetworkModel<T>& model_;
  AdaHessian<T> step_;
  Rng probes_;
  std::uint64_t updates_ = 0;
  Vector<T> probe_, curvature_, next_;
};

extern template class AdaHessianRule<float>;
extern template class AdaHessianRule<double>;

}  // namespace physinv
