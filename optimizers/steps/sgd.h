/// Gradient descent with (heavy-ball) momentum: u = momentum u + g,
/// x -= rate u. An object belongs to one vector.
#pragma once

#include "optimizers/steps/simd.h"
#include "suite/core/archive.h"
#include "suite/core/batch.h"
#include "suite/core/check.h"
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
class Sgd {
 public:
  using Options = SgdOptions;
  static constexpr Index kNumbersPerParameter = 1;
  explicit Sgd(const Options& options = {}) : options_(options) {}

  void step(VectorOut<T> x, VectorIn<T> gradient) { step(x, gradient, x); }
  /// Leaves x and writes the new one to `to`, which may be the gradient.
  void step(VectorIn<T> x, VectorIn<T> gradient, VectorOut<T> to) {
    SUITE_CHECK(x.size() == gradient.size() && x.size() == to.size(),
                "vectors of another size");
    if (!started_) u_.setZero(x.size());
    SUITE_CHECK(x.size() == u_.size(), "the vector changed its size");
    started_ = true;
    const T rate = static_cast<T>(options_.rate);
    const T momentum = static_cast<T>(options_.momentum);
    T *const out = to.data(), *const pu = u_.data();
    const T *const px = x.data(), *const pg = gradient.data();
    using R = steps::Register<T>;
    steps::for_registers<T>(x.size(), [=](Index i, auto lanes) {
      const auto u = R::multiply_add(
          R::all(momentum), R::load(pu + i, lanes), R::load(pg + i, lanes));
      R::store(pu + i, u, lanes);
      R::store(out + i,
               R::multiply_add(R::all(-rate), u, R::load(px + i, lanes)),
               lanes);
    });
  }

  /// Forgets the momentum.
  void reset() { started_ = false; }
  void keep(Archive& archive) { archive(u_, started_); }

 private:
  Options options_;
  Vector<T> u_;
  bool started_ = false;
};

}  // namespace physinv
