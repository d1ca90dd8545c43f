/// Adam (Kingma and Ba 2015, algorithm 1), without weight decay:
///
///   m = beta1 m + (1 - beta1) g          v = beta2 v + (1 - beta2) g^2
///   x -= rate m' / (sqrt(v') + eps)      m' = m / (1 - beta1^t), v' alike
///
/// Moments below 1e-31 (float; 1e-292 double) are set to zero: next to eps they
/// move nothing. One pass over x, g, m and v. Moments start at zero on the
/// first step; an object belongs to one vector.
#pragma once

#include <cmath>
#include <limits>

#include "optimizers/steps/simd.h"
#include "suite/core/archive.h"
#include "suite/core/batch.h"
#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/options.h"

namespace physinv {

struct AdamOptions {
  double rate = 1e-3;
  double beta1 = 0.9, beta2 = 0.999;
  double eps = 1e-7;  ///< as in the authors' framework; PyTorch has 1e-8
  /// Keras' form: eps is added to the root of the uncorrected v.
  bool eps_before_correction = false;

  auto fields() const {
    return std::tuple{word("step", "adam"),
                      field("rate", rate),
                      field("beta1", beta1),
                      field("beta2", beta2),
                      field("eps", eps),
                      field("eps_before_correction", eps_before_correction)};
  }
};

template <class T>
class Adam {
 public:
  using Options = AdamOptions;
  static constexpr Index kNumbersPerParameter = 2;
  explicit Adam(const Options& options = {}) : options_(options) {}

  void step(VectorOut<T> x, VectorIn<T> gradient) { step(x, gradient, x); }
  /// Leaves x and writes the new one to `to`, which may be the gradient.
  void step(VectorIn<T> x, VectorIn<T> gradient, VectorOut<T> to);

  /// Forgets the moments; the next step is a first one.
  void reset() { steps_ = 0; }
  void keep(Archive& archive) { archive(m_, v_, steps_); }

 private:
  Options options_;
  Vector<T> m_, v_;
  long steps_ = 0;
};

template <class T>
void Adam<T>::step(VectorIn<T> x, VectorIn<T> gradient, VectorOut<T> to) {
  SUITE_CHECK(x.size() == gradient.size() && x.size() == to.size(),
              "vectors of another size");
  if (steps_ == 0) m_.setZero(x.size()), v_.setZero(x.size());
  SUITE_CHECK(x.size() == m_.size(), "the vector changed its size");
  ++steps_;
  const auto t = static_cast<double>(steps_);
  const Options& o = options_;
  const double c1 = 1 - math::pow(o.beta1, t), c2 = 1 - math::pow(o.beta2, t);
  const bool before = o.eps_before_correction;
  const T rate = static_cast<T>(o.rate / c1 * (before ? std::sqrt(c2) : 1.0));
  const T correct = static_cast<T>(before ? 1.0 : 1 / c2);
  const T b1 = static_cast<T>(o.beta1), a1 = static_cast<T>(1 - o.beta1);
  const T b2 = static_cast<T>(o.beta2), a2 = static_cast<T>(1 - o.beta2);
  const T eps = static_cast<T>(o.eps);
  const T *const px = x.data(), *const pg = gradient.data();
  T* const out = to.data();
  T *const pm = m_.data(), *const pv = v_.data();
  using R = steps::Register<T>;
  // A gradient that stays zero lets its moments decay into denormal numbers,
  // which never reach zero and take several times as long.
  const T tiny =
      std::numeric_limits<T>::min() / std::numeric_limits<T>::epsilon();
  steps::for_registers<T>(x.size(), [=](Index i, auto lanes) {
    const auto g = R::load(pg + i, lanes);
    const auto m = R::without_tiny(
        R::multiply_add(R::all(b1), R::load(pm + i, lanes), a1 * g), tiny);
    const auto v = R::without_tiny(
        R::multiply_add(R::all(b2), R::load(pv + i, lanes), a2 * (g * g)),
        tiny);
    R::store(pm + i, m, lanes);
    R::store(pv + i, v, lanes);
    const auto scaled = v * correct;
    const auto step = rate * m / (R::root(scaled) + eps);
    R::store(out + i, R::load(px + i, lanes) - step, lanes);
  });
}

}  // namespace physinv
