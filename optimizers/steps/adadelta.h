/// Adadelta (Zeiler 2012) as Keras has it:
///
///   a = decay a + (1 - decay) g^2
///   d = sqrt(c + eps) / sqrt(a + eps) g          x -= rate d
///   c = decay c + (1 - decay) d^2
#pragma once

#include "optimizers/steps/elementwise.h"
#include "suite/core/options.h"

namespace physinv {

struct AdadeltaOptions {
  double rate = 1.0;
  double decay = 0.95;
  double eps = 1e-7;

  auto fields() const {
    return std::tuple{word("step", "adadelta"),
                      field("rate", rate),
                      field("decay", decay),
                      field("eps", eps)};
  }
};

template <class T>
class Adadelta : public ElementwiseStep<T, Adadelta<T>, 2> {
 public:
  using Options = AdadeltaOptions;
  explicit Adadelta(const Options& options = {}) : options_(options) {}

  auto update(long /*step*/) const {
    using V = Pack<T>;
    const T rate = static_cast<T>(options_.rate);
    const T decay = static_cast<T>(options_.decay);
    const T fresh = static_cast<T>(1 - options_.decay);
    const T eps = static_cast<T>(options_.eps);
    return [=](V x, V g, V & a, V & c) __attribute__((always_inline)) {
      a = fma_lanes(decay, a, fresh * (g * g));
      const V d = sqrt_lanes(c + eps) / sqrt_lanes(a + eps) * g;
      c = fma_lanes(decay, c, fresh * (d * d));
      return fma_lanes(-rate, d, x);
    };
  }

 private:
  Options options_;
};

}  // namespace physinv
