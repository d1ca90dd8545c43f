/// RMSprop (Tieleman and Hinton 2012) as Keras has it, without momentum:
///
///   a = decay a + (1 - decay) g^2          x -= rate g / (sqrt(a) + eps)
#pragma once

#include "optimizers/steps/elementwise.h"
#include "suite/core/options.h"

namespace physinv {

struct RmspropOptions {
  double rate = 1e-3;
  double decay = 0.9;
  double eps = 1e-7;

  auto fields() const {
    return std::tuple{word("step", "rmsprop"),
                      field("rate", rate),
                      field("decay", decay),
                      field("eps", eps)};
  }
};

template <class T>
class Rmsprop : public ElementwiseStep<T, Rmsprop<T>, 1> {
 public:
  using Options = RmspropOptions;
  explicit Rmsprop(const Options& options = {}) : options_(options) {}

  auto update(long /*step*/) const {
    using V = Pack<T>;
    const T rate = static_cast<T>(options_.rate);
    const T decay = static_cast<T>(options_.decay);
    const T fresh = static_cast<T>(1 - options_.decay);
    const T eps = static_cast<T>(options_.eps);
    return [=](V x, V g, V & a) __attribute__((always_inline)) {
      a = fma_lanes(decay, a, fresh * (g * g));
      return x - rate * g / (sqrt_lanes(a) + eps);
    };
  }

 private:
  Options options_;
};

}  // namespace physinv
