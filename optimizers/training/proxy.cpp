#include "optimizers/training/proxy.h"

#include <cmath>

#include "optimizers/training/batch_signal.h"
#include "suite/core/oracle.h"

namespace physinv {
namespace {

/// Keeps 0 and NaN.
template <class T>
T sign(T v) {
  return v > T(0) ? T(1) : v < T(0) ? T(-1) : v;
}

/// S is the precision of the solver.
template <class T, ProxyNorm norm, class S = T>
class Proxy final : public BatchSignal<T> {
 public:
  explicit Proxy(const SignalPlace<T>& place)
      : BatchSignal<T>(place),
        problem_(place.run.oracle.template problem<S>()) {
    if constexpr (!std::is_same_v<S, T>) place.batches.keep_exact();
  }

  Counts counts() const override { return problem_.counts(); }
  std::size_t bytes() const override {
    return BatchSignal<T>::bytes() +
           static_cast<std::size_t>(wanted_.size()) * sizeof(S) +
           problem_.bytes();
  }

 private:
  void push(BatchIn<T> x,
            Index first,
            VectorOut<double> loss,
            BatchOut<T> x_bar) override {
    const Index n = x.cols();
    wanted_.resize(x.rows(), n);
    const auto given = this->batches_.given(first, n);
    if constexpr (std::is_same_v<S, T>) {
      const auto target = this->batches_.target(first, n);
      problem_.invert(target, given, x, wanted_);
    } else {
      problem_.invert(this->batches_.exact_target(first, n),
                      given.template cast<S>(),
                      x.template cast<S>(),
                      wanted_);
    }
    for (Index i = 0; i < n; ++i) {
      double sum = 0;
      for (Index j = 0; j < x.rows(); ++j) {
        const T away = static_cast<T>(static_cast<S>(x(j, i)) - wanted_(j, i));
        const auto a = static_cast<double>(away);
        if constexpr (norm == ProxyNorm::square) {
          sum = std::fma(0.5 * a, a, sum);
          x_bar(j, i) = this->factor_ * away;
        } else {
          sum += std::abs(a);
          x_bar(j, i) = this->factor_ * sign(away);
        }
      }
      loss(i) = sum;
    }
  }

  CountedProblem<S> problem_;
  Batch<S> wanted_;
};

template <class T>
using SquareProxy = Proxy<T, ProxyNorm::square>;
template <class T>
using AbsoluteProxy = Proxy<T, ProxyNorm::absolute>;
template <class T>
using ExactSquareProxy = Proxy<T, ProxyNorm::square, double>;
template <class T>
using ExactAbsoluteProxy = Proxy<T, ProxyNorm::absolute, double>;

}  // namespace

SignalRecipe inverse_proxy(ProxyNorm norm, ProxyPrecision precision) {
  constexpr auto kNeeds = Needs::inverse;
  const bool square = norm == ProxyNorm::square;
  if (precision == ProxyPrecision::of_network) {
    if (square) return batch_signal<SquareProxy>("sip", kNeeds, kNeeds);
    return batch_signal<AbsoluteProxy>("sip, absolute", kNeeds, kNeeds);
  }
  if (square)
    return batch_signal<ExactSquareProxy>("sip in double", kNeeds, kNeeds);
  return batch_signal<ExactAbsoluteProxy>(
      "sip in double, absolute", kNeeds, kNeeds);
}

}  // namespace physinv
