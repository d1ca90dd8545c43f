/// Gradient descent with (heavy-ball) momentum: u = momentum u + g,
/// x -= rate u.
#pragma once

#include "optimizers/steps/elementwise.h"
#include "suite/core/options.h"

namespace physinv {

struct SgdOptions {
  double rate = 1e-2;
  double momentum = 0.0;

  auto fields() const {
    return std::tuple{
        word("step", "sgd"), field("rate", rate), field("momentum", momentum)};
  }
};

template <class T>
class Sgd : public ElementwiseStep<T, Sgd<T>, 1> {
 public:
  using Options = SgdOptions;
  explicit Sgd(const Options& options = {}) : options_(options) {}

  auto update(long /*step*/) const {
    using V = Pack<T>;
    const T rate = static_cast<T>(options_.rate);
    const T momentum = static_cast<T>(options_.momentum);
    return [=](V x, V g, V & u) __attribute__((always_inline)) {
      u = fma_lanes(momentum, u, g);
      return fma_lanes(-rate, u, x);
    };
  }

 private:
  Options options_;
};

}  // namespace physinv
