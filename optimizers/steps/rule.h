/// Any of the first-order update rules, chosen by its options.
///
///   UpdateStep<float> step(AdamOptions{.rate = 1e-3});
///   step(weights, gradient);
#pragma once

#include <variant>

#include "optimizers/steps/adadelta.h"
#include "optimizers/steps/adagrad.h"
#include "optimizers/steps/adam.h"
#include "optimizers/steps/rmsprop.h"
#include "optimizers/steps/sgd.h"
#include "suite/core/method.h"

namespace physinv {

using StepOptions = std::variant<AdamOptions,
                                 SgdOptions,
                                 AdagradOptions,
                                 AdadeltaOptions,
                                 RmspropOptions>;

/// Of these rules, only the chosen one matters to a stage.
void add_sources(const StepOptions& options, Sources& sources);

template <class T>
class UpdateStep {
 public:
  explicit UpdateStep(const StepOptions& options)
      : rule_(std::visit([](const auto& o) { return make(o); }, options)) {}

  void operator()(VectorOut<T> x, VectorIn<T> gradient) {
    (*this)(x, gradient, x);
  }

  /// Leaves x and writes the new one to `to`, which may be the gradient.
  void operator()(VectorIn<T> x, VectorIn<T> gradient, VectorOut<T> to) {
    std::visit([&](auto& rule) { rule.step(x, gradient, to); }, rule_);
  }

  void serialize(Archive& archive) {
    std::visit([&](auto& rule) { rule.serialize(archive); }, rule_);
  }

  /// That the rule keeps.
  Index numbers_per_parameter() const {
    return std::visit(
        [](const auto& rule) { return rule.kNumbersPerParameter; }, rule_);
  }

 private:
  using Rule =
      std::variant<Adam<T>, Sgd<T>, Adagrad<T>, Adadelta<T>, Rmsprop<T>>;

  static Rule make(const AdamOptions& o) { return Adam<T>(o); }
  static Rule make(const SgdOptions& o) { return Sgd<T>(o); }
  static Rule make(const AdagradOptions& o) { return Adagrad<T>(o); }
  static Rule make(const AdadeltaOptions& o) { return Adadelta<T>(o); }
  static Rule make(const RmspropOptions& o) { return Rmsprop<T>(o); }

  Rule rule_;
};

}  // namespace physinv
