#include "optimizers/training/batch_signal.h"

#include <algorithm>
#include <cmath>

#include "optimizers/metrics.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {

template <class T>
BatchSignal<T>::BatchSignal(const SignalPlace<T>& place)
    : run_(place.run),
      model_(place.model),
      batches_(place.batches),
      options_(place.options),
      factor_(static_cast<T>(options_.gradient_scale /
                             static_cast<double>(batches_.size()))),
      map_(output_map<T>(run_.setting, run_.oracle)),
      loss_(batches_.size()) {}

template <class T>
const Batch<T>& BatchSignal<T>::estimate(Index first, Index count) {
  const Batch<T>& out = model_.forward(batches_.input(first, count));
  x_.resizeLike(out);
  (*map_)(out, batches_.target(first, count), x_);
  model_.update_state();
  if (options_.late.of) note_late(first, count);
  return x_;
}

template <class T>
void BatchSignal<T>::note_late(Index first, Index count) {
  Probe& probe = run_.probe;
  const auto all = static_cast<double>(probe.iterations());
  if (static_cast<double>(probe.iteration()) <=
      all - std::ceil(options_.late.share * all))
    return;
  probe.pause();
  late_ +=
      static_cast<double>(count) *
      options_.late.of(x_.template cast<double>(),
                       batches_.target(first, count).template cast<double>());
  late_samples_ += count;
  probe.resume();
}

template <class T>
Vector<T>& BatchSignal<T>::gradient_of(Index first, Index count) {
  estimate(first, count);
  x_bar_.resizeLike(x_);
  push(x_, first, loss_.segment(first, count), x_bar_);
  map_->pull_back(x_bar_);
  return model_.backward(x_bar_);
}

template <class T>
Vector<T>& BatchSignal<T>::gradient() {
  const Index n = batches_.size();
  const Index most = options_.chunk > 0 ? std::min(options_.chunk, n) : n;
  if (most == n) {
    Vector<T>& whole = gradient_of(0, n);
    note_loss();
    return whole;
  }
  SUITE_CHECK(model_.state().size() == 0, "batch statistics need the batch");
  sum_.setZero(model_.parameters().size());
  for (Index first = 0; first < n; first += most)
    sum_ += gradient_of(first, std::min(most, n - first));
  note_loss();
  return sum_;
}

template <class T>
Jacobians<T> BatchSignal<T>::jacobians() {
  const Index n = batches_.size();
  const Batch<T>& x = estimate(0, n);
  x_bar_.resizeLike(x);
  push(x, 0, loss_, x_bar_);
  const Index d = x.rows();
  identity_.setZero(d * d, n);
  for (Index k = 0; k < d; ++k) identity_.row(k * (d + 1)).setOnes();
  map_->pull_back_rows(identity_);
  note_loss();
  return {identity_, x_bar_};
}

template <class T>
void BatchSignal<T>::leave(Outcome& out) const {
  out.arrays["batch_loss"] = as_row(losses_);
  if (late_samples_ > 0)
    out.arrays["late_error"] = Batch<double>::Constant(
        1, 1, late_ / static_cast<double>(late_samples_));
}

template <class T>
std::size_t BatchSignal<T>::bytes() const {
  return static_cast<std::size_t>(x_.size() + x_bar_.size() + identity_.size() +
                                  sum_.size()) *
         sizeof(T);
}

template class BatchSignal<float>;
template class BatchSignal<double>;

}  // namespace physinv
