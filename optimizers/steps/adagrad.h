/// Adagrad (Duchi, Hazan and Singer 2011) as Keras has it:
///
///   a += g^2   from a = accumulator        x -= rate g / (sqrt(a) + eps)
///
/// An object belongs to one vector.
#pragma once

#include "optimizers/steps/simd.h"
#include "suite/core/archive.h"
#include "suite/core/batch.h"
#include "suite/core/check.h"
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
class Adagrad {
 public:
  using Options = AdagradOptions;
  static constexpr Index kNumbersPerParameter = 1;
  explicit Adagrad(const Options& options = {}) : options_(options) {}

  void step(VectorOut<T> x, VectorIn<T> gradient) { step(x, gradient, x); }
  /// Leaves x and writes the new one to `to`, which may be the gradient.
  void step(VectorIn<T> x, VectorIn<T> gradient, VectorOut<T> to) {
    SUITE_CHECK(x.size() == gradient.size() && x.size() == to.size(),
                "vectors of another size");
    if (!started_)
      a_.setConstant(x.size(), static_cast<T>(options_.accumulator));
    SUITE_CHECK(x.size() == a_.size(), "the vector changed its size");
    started_ = true;
    const T rate = static_cast<T>(options_.rate);
    const T eps = static_cast<T>(options_.eps);
    T *const out = to.data(), *const pa = a_.data();
    const T *const px = x.data(), *const pg = gradient.data();
    using R = steps::Register<T>;
    steps::for_registers<T>(x.size(), [=](Index i, auto lanes) {
      const auto g = R::load(pg + i, lanes);
      const auto a = R::multiply_add(g, g, R::load(pa + i, lanes));
      R::store(pa + i, a, lanes);
      const auto step = rate * g / (R::root(a) + eps);
      R::store(out + i, R::load(px + i, lanes) - step, lanes);
    });
  }

  /// Forgets the sum of squares.
  void reset() { started_ = false; }
  void keep(Archive& archive) { archive(a_, started_); }

 private:
  Options options_;
  Vector<T> a_;
  bool started_ = false;
};

}  // namespace physinv
