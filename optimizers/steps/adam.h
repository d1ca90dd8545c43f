/// Adam (Kingma and Ba 2015, algorithm 1), without weight decay:
///
///   m = beta1 m + (1 - beta1) g          v = beta2 v + (1 - beta2) g^2
///   x -= rate m' / (sqrt(v') + eps)      m' = m / (1 - beta1^t), v' alike
///
/// Moments below 1e-31 (float; 1e-292 double) are set to zero: next to eps they
/// move nothing.
#pragma once

#include <cmath>
#include <limits>

#include "optimizers/steps/elementwise.h"
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
class Adam : public ElementwiseStep<T, Adam<T>, 2> {
 public:
  using Options = AdamOptions;
  explicit Adam(const Options& options = {}) : options_(options) {}

  auto update(long step) const {
    using V = Pack<T>;
    const auto t = static_cast<double>(step);
    const Options& o = options_;
    const double c1 = 1 - math::pow(o.beta1, t), c2 = 1 - math::pow(o.beta2, t);
    const bool before = o.eps_before_correction;
    const T rate = static_cast<T>(o.rate / c1 * (before ? std::sqrt(c2) : 1.0));
    const T correct = static_cast<T>(before ? 1.0 : 1 / c2);
    const T b1 = static_cast<T>(o.beta1), a1 = static_cast<T>(1 - o.beta1);
    const T b2 = static_cast<T>(o.beta2), a2 = static_cast<T>(1 - o.beta2);
    const T eps = static_cast<T>(o.eps);
    // A gradient that stays zero lets its moments decay into denormal numbers,
    // which never reach zero and take several times as long.
    const T tiny =
        std::numeric_limits<T>::min() / std::numeric_limits<T>::epsilon();
    return [=](V x, V g, V & m, V & v) __attribute__((always_inline)) {
      // NaN stays.
      const auto without_tiny = [=](V moment) {
        return select((moment < tiny) & (moment > -tiny), V{}, moment);
      };
      m = without_tiny(fma_lanes(b1, m, a1 * g));
      v = without_tiny(fma_lanes(b2, v, a2 * (g * g)));
      const V scaled = v * correct;
      return x - rate * m / (sqrt_lanes(scaled) + eps);
    };
  }

 private:
  Options options_;
};

}  // namespace physinv
