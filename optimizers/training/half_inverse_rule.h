/// The half-inverse step (half_inverse_step.h) as a rule. Leaves per update
/// `kept` (singular values), `smallest` (kept, relative to the largest) and
/// `path` (hig::Path), and `unproven` (1), the number of updates whose accuracy
/// was not shown.
#pragma once

#include <vector>

#include "optimizers/half_inverse/half_inverse_step.h"
#include "optimizers/training/rule.h"

namespace physinv {

template <class T>
class HalfInverseRule final : public Rule<T> {
 public:
  HalfInverseRule(const HalfInverseStepOptions& options,
                  NetworkModel<T>& model,
                  Threads* threads)
      : model_(model), step_(options, threads) {}

  bool operator()(Signal<T>& signal) override;
  void serialize(Archive& archive) override {
    archive(kept_, smallest_, path_, unproven_);
  }
  void export_to(Outcome& out) const override;
  std::size_t bytes() const override { return step_.bytes(); }

 private:
  NetworkModel<T>& model_;
  HalfInverseStep<T> step_;
  std::vector<double> kept_, smallest_, path_;
  double unproven_ = 0;
};

extern template class HalfInverseRule<float>;
extern template class HalfInverseRule<double>;

}  // namespace physinv
