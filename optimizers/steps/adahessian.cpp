#include "optimizers/steps/adahessian.h"

#include <cmath>

#include "suite/core/check.h"
#include "suite/core/math.h"

namespace physinv {
namespace {

/// h = |h|, averaged over the taps of every kernel, which lie side by side.
template <class T>
void average(const std::vector<TensorInfo>& tensors, VectorOut<T> h) {
  for (const TensorInfo& t : tensors) {
    // fan_in = inputs taps, fan_out = outputs taps, size = inputs outputs taps
    const Index taps = t.kind == 'k' ? t.fan_in * t.fan_out / t.size : 1;
    for (Index i = t.offset; i < t.offset + t.size; i += taps) {
      double sum = 0;
      for (Index k = 0; k < taps; ++k) sum += std::abs(double(h(i + k)));
      h.segment(i, taps).setConstant(static_cast<T>(sum / double(taps)));
    }
  }
}

}  // namespace

template <class T>
void AdaHessian<T>::step(VectorIn<T> x,
                         VectorIn<T> gradient,
                         VectorOut<T> curvature,
                         VectorOut<T> to) {
  SUITE_CHECK(x.size() == gradient.size() && x.size() == curvature.size() &&
                  x.size() == to.size(),
              "vectors must have the same size");
  if (steps_ == 0) m_.setZero(x.size()), v_.setZero(x.size());
  SUITE_CHECK(m_.size() == x.size() && v_.size() == x.size(),
              "the size of the vector must not change");
  ++steps_;
  average<T>(tensors_, curvature);
  const auto t = static_cast<double>(steps_);
  const auto& o = options_;
  const double c1 = 1 - math::pow(o.beta1, t), c2 = 1 - math::pow(o.beta2, t);
  // The product with H takes a thousand times as long: numbers one by one.
  for (Index i = 0; i < x.size(); ++i) {
    const auto g = double(gradient(i)), h = double(curvature(i));
    m_(i) = static_cast<T>(o.beta1 * double(m_(i)) + (1 - o.beta1) * g);
    v_(i) = static_cast<T>(o.beta2 * double(v_(i)) + (1 - o.beta2) * (h * h));
    const double root = std::sqrt(double(v_(i)) / c2);
    const double size =
        o.power == 0.5 ? std::sqrt(root) : math::pow(root, o.power);
    to(i) = static_cast<T>(double(x(i)) -
                           o.rate * (double(m_(i)) / c1) / (size + o.eps));
  }
}

template class AdaHessian<float>;
template class AdaHessian<double>;

}  // namespace physinv
