/// Adadelta (Zeiler 2012) as Keras has it:
///
///   a = decay a + (1 - decay) g^2
///   d = sqrt(c + eps) / sqrt(a + eps) g          x -= rate d
///   c = decay c + (1 - decay) d^2
///
/// An object belongs to one vector.
#pragma once

#include "optimizers/steps/simd.h"
#include "suite/core/archive.h"
#include "suite/core/batch.h"
#include "suite/core/check.h"
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
class Adadelta {
 public:
  using Options = AdadeltaOptions;
  static constexpr Index kNumbersPerParameter = 2;
  explicit Adadelta(const Options& options = {}) : options_(options) {}

  void step(VectorOut<T> x, VectorIn<T> gradient) { step(x, gradient, x); }
  /// Leaves x and writes the new one to `to`, which may be the gradient.
  void step(VectorIn<T> x, VectorIn<T> gradient, VectorOut<T> to) {
    SUITE_CHECK(x.size() == gradient.size() && x.size() == to.size(),
                "vectors of another size");
    if (!started_) a_.setZero(x.size()), c_.setZero(x.size());
    SUITE_CHECK(x.size() == a_.size(), "the vector changed its size");
    started_ = true;
    const T rate = static_cast<T>(options_.rate);
    const T decay = static_cast<T>(options_.decay);
    const T fresh = static_cast<T>(1 - options_.decay);
    const T eps = static_cast<T>(options_.eps);
    T *const out = to.data(), *const pa = a_.data(), *const pc = c_.data();
    const T *const px = x.data(), *const pg = gradient.data();
    using R = steps::Register<T>;
    steps::for_registers<T>(x.size(), [=](Index i, auto lanes) {
      const auto g = R::load(pg + i, lanes);
      const auto c = R::load(pc + i, lanes);
      const auto a = R::multiply_add(
          R::all(decay), R::load(pa + i, lanes), fresh * (g * g));
      const auto d = R::root(c + eps) / R::root(a + eps) * g;
      R::store(pa + i, a, lanes);
      R::store(
          pc + i, R::multiply_add(R::all(decay), c, fresh * (d * d)), lanes);
      R::store(out + i,
               R::multiply_add(R::all(-rate), d, R::load(px + i, lanes)),
               lanes);
    });
  }

  /// Forgets both means.
  void reset() { started_ = false; }
  void keep(Archive& archive) { archive(a_, c_, started_); }

 private:
  Options options_;
  Vector<T> a_, c_;
  bool started_ = false;
};

}  // namespace physinv
