/// AdaHessian (Yao et al. 2021), as the SIP paper's authors use it: Adam with a
/// noisy diagonal of the Hessian in place of the squared gradient. With a
/// vector z of independent signs,
///
///   h = |H z|, of a convolution's kernel the mean over its taps
///   m = beta1 m + (1 - beta1) g     v = beta2 v + (1 - beta2) h^2
///   x -= rate m' / (sqrt(v')^power + eps)
///
/// m' = m / (1 - beta1^t), v' alike.
#pragma once

#include <vector>

#include "suite/core/archive.h"
#include "suite/core/network.h"
#include "suite/core/options.h"
#include "suite/core/recipe.h"

namespace physinv {

struct AdaHessianOptions {
  double rate = 1e-6;
  double power = 0.5;
  double beta1 = 0.9, beta2 = 0.999;
  double eps = 1e-4;

  auto fields() const {
    return std::tuple{word("step", "adahessian"),
                      field("rate", rate),
                      field("power", power),
                      field("beta1", beta1),
                      field("beta2", beta2),
                      field("eps", eps)};
  }
};

template <class T>
class AdaHessian {
 public:
  static constexpr Index kNumbersPerParameter = 2;
  AdaHessian(const AdaHessianOptions& options,
             const std::vector<TensorInfo>& tensors)
      : options_(options), tensors_(tensors) {}

  /// `curvature` is H z and becomes h. Leaves x and writes the new one to `to`,
  /// which may be the gradient.
  void step(VectorIn<T> x,
            VectorIn<T> gradient,
            VectorOut<T> curvature,
            VectorOut<T> to);

  void serialize(Archive& archive) { archive(m_, v_, steps_); }

 private:
  AdaHessianOptions options_;
  std::vector<TensorInfo> tensors_;
  Vector<T> m_, v_;
  long steps_ = 0;
};

extern template class AdaHessian<float>;
extern template class AdaHessian<double>;

}  // namespace physinv
