/// Adagrad (Duchi, Hazan and Singer 2011) as Keras has it:
///
///   a += g^2   from a = accumulator        x -= rate g / (sqrt(a) + eps)
#pragma once

#include "optimizers/steps/elementwise.h"
#include "suite/core/options.h"

namespace physinv {

struct AdagradOptions {
  double rate = 1e-2;
  double accumulator = 0.1;  ///< a before the first step; PyTorch has 0
  double eps = 1e-7;

  auto fields() const {
    return std::tuple{word("step", "adagrad"),
                      field("rate", rate),
                      field("accumulator", accumulator),
                      field("eps", eps)};
  }
};

template <class T>
class Adagrad : public ElementwiseStep<T, Adagrad<T>, 1> {
 public:
  using Options = AdagradOptions;
  explicit Adagrad(const Options& options = {})
      : ElementwiseStep<T, Adagrad<T>, 1>(static_cast<T>(options.accumulator)),
        options_(options) {}

  auto update(long /*step*/) const {
    using V = Pack<T>;
    const T rate = static_cast<T>(options_.rate);
    const T eps = static_cast<T>(options_.eps);
    return [=](V x, V g, V & a) __attribute__((always_inline)) {
      a = fma_lanes(g, g, a);
      return x - rate * g / (sqrt_lanes(a) + eps);
    };
  }

 private:
  Options options_;
};

}  // namespace physinv
