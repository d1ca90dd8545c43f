#include "optimizers/training/label_loss.h"

#include <cmath>

#include "optimizers/training/batch_signal.h"

namespace physinv {
namespace {

template <class T>
class LabelLoss final : public BatchSignal<T> {
 public:
  explicit LabelLoss(const SignalPlace<T>& place) : BatchSignal<T>(place) {
    place.batches.keep_labels();
  }

 private:
  void push(BatchIn<T> x,
            Index first,
            VectorOut<double> loss,
            BatchOut<T> x_bar) override {
    const auto label = this->batches_.label(first, x.cols());
    for (Index i = 0; i < x.cols(); ++i) {
      double sum = 0;
      for (Index j = 0; j < x.rows(); ++j) {
        const T away = x(j, i) - label(j, i);
        const auto a = static_cast<double>(away);
        sum = std::fma(0.5 * a, a, sum);
        x_bar(j, i) = this->factor_ * away;
      }
      loss(i) = sum;
    }
  }
};

}  // namespace

SignalRecipe label_loss() {
  return batch_signal<LabelLoss>("labels", Needs::labels, Needs::labels);
}

}  // namespace physinv
