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

template <class T, ProxyNorm norm>
class Proxy final : public BatchSignal<T> {
 public:
  explicit Proxy(const SignalPlace<T>& place)
      : BatchSignal<T>(place),
        problem_(place.run.oracle.recipe().template make<T>()),
        inverse_(dynamic_cast<const Inverse<T>&>(*problem_)),
        work_(place.run.threads) {}

  Counts counts() const override {
    Counts all = counts_;
    all += work_.counts;
    return all;
  }
  std::size_t bytes() const override {
    return BatchSignal<T>::bytes() +
           static_cast<std::size_t>(wanted_.size()) * sizeof(T) + work_.bytes();
  }

 private:
  void push(BatchIn<T> x,
            Index first,
            VectorOut<double> loss,
            BatchOut<T> x_bar) override {
    const Index n = x.cols();
    wanted_.resize(x.rows(), n);
    inverse_.invert(this->batches_.target(first, n),
                    this->batches_.given(first, n),
                    x,
                    wanted_,
                    work_);
    counts_[Counter::inverse] += static_cast<std::uint64_t>(n);
    for (Index i = 0; i < n; ++i) {
      double sum = 0;
      for (Index j = 0; j < x.rows(); ++j) {
        const T away = x(j, i) - wanted_(j, i);
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

  std::unique_ptr<Problem<T>> problem_;
  const Inverse<T>& inverse_;
  Batch<T> wanted_;
  Workspace work_;
  Counts counts_;
};

template <class T>
using SquareProxy = Proxy<T, ProxyNorm::square>;
template <class T>
using AbsoluteProxy = Proxy<T, ProxyNorm::absolute>;

}  // namespace

SignalRecipe inverse_proxy(ProxyNorm norm) {
  if (norm == ProxyNorm::square)
    return batch_signal<SquareProxy>("sip", Needs::inverse, Needs::inverse);
  return batch_signal<AbsoluteProxy>(
      "sip, absolute", Needs::inverse, Needs::inverse);
}

}  // namespace physinv
