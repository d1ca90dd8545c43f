#include "optimizers/training/newton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "optimizers/training/batch_signal.h"
#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/core/oracle.h"
#include "suite/linalg/decompositions.h"

namespace physinv {
namespace {

/// s of one direction; denominators up to `zero` are.
double along(const NewtonOptions& o, double q, double h, double zero) {
  const double bottom = h + o.damping;
  if (std::abs(bottom) <= zero || q == 0) return 0;
  const double size = std::min(std::abs(q / bottom), o.limit);
  const bool down = o.flip || bottom > 0;
  return std::copysign(size, down ? q : -q);
}

template <class T>
class NewtonProxy final : public BatchSignal<T> {
 public:
  NewtonProxy(const SignalPlace<T>& place, const NewtonOptions& options)
      : BatchSignal<T>(place),
        newton_(options),
        problem_(place.run.oracle.template problem<T>()) {}

  Counts counts() const override { return problem_.counts(); }
  std::size_t bytes() const override {
    return BatchSignal<T>::bytes() +
           static_cast<std::size_t>(y_.size() + y_bar_.size() + h_.size()) *
               sizeof(T) +
           problem_.bytes();
  }

 private:
  void push(BatchIn<T> x,
            Index first,
            VectorOut<double> loss,
            BatchOut<T> x_bar) override {
    const Index n = x.cols(), d = x.rows();
    const auto given = this->batches_.given(first, n);
    const auto target = this->batches_.target(first, n);
    y_.resize(target.rows(), n);
    y_bar_.resizeLike(y_);
    h_.resize(d * d, n);
    problem_.linearize(x, given, y_);
    problem_.loss_gradient(y_, target, y_bar_);
    problem_.pullback(y_bar_, x_bar);
    problem_.hessian(x, given, target, h_);
    for (Index i = 0; i < n; ++i) {
      const Eigen::Map<const Batch<T>> h(h_.col(i).data(), d, d);
      const Vector<double> dx =
          newton_step(newton_,
                      x_bar.col(i).template cast<double>(),
                      h.template cast<double>(),
                      std::numeric_limits<T>::epsilon());
      loss(i) = 0.5 * dx.squaredNorm();
      x_bar.col(i) = (-double(this->factor_) * dx).template cast<T>();
    }
  }

  NewtonOptions newton_;
  CountedProblem<T> problem_;
  Batch<T> y_, y_bar_, h_;
};

template <class T>
SignalRecipe::Make<T> maker(const NewtonOptions& options) {
  return [options](const SignalPlace<T>& place) {
    return std::make_unique<NewtonProxy<T>>(place, options);
  };
}

}  // namespace

Vector<double> newton_step(const NewtonOptions& options,
                           const Vector<double>& gradient,
                           const Batch<double>& hessian,
                           double epsilon) {
  const Index d = gradient.size();
  if (!gradient.allFinite() || !hessian.allFinite())
    return Vector<double>::Constant(d, std::nan(""));
  if (d == 1)
    return Vector<double>::Constant(1,
                                    -along(options,
                                           gradient(0),
                                           hessian(0, 0),
                                           epsilon * std::abs(hessian(0, 0))));
  const linalg::SymmetricEigen parts = linalg::symmetric_eigen(hessian);
  Vector<double> q = parts.vectors.transpose() * gradient;
  const double zero =
      static_cast<double>(d) * epsilon * parts.values.cwiseAbs().maxCoeff();
  for (Index k = 0; k < d; ++k)
    q(k) = along(options, q(k), parts.values(k), zero);
  return -parts.vectors * q;
}

SignalRecipe newton_proxy(const NewtonOptions& options) {
  check_numbers<double>({{"damping", options.damping}});
  SUITE_CHECK(options.limit > 0,
              "limit must be positive; give inf for no limit");
  constexpr Needs needs = Needs::vjp | Needs::hessian;
  return {.algorithm = fmt::format("newton flip={} damping={} limit={}",
                                   options.flip,
                                   options.damping,
                                   options.limit),
          .gradient = needs,
          .jacobians = needs,
          .make_float = maker<float>(options),
          .make_double = maker<double>(options),
          .source = __FILE__};
}

}  // namespace physinv
