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
  const Probe& probe = run_.probe;
  const auto all = static_cast<double>(probe.iterations());
  if (static_cast<double>(probe.iteration()) <=
      all - std::ceil(options_.late.share * all))
    return;
  const Probe::Aside aside = run_.probe.measuring();
  late_ +=
      static_cast<double>(count) *
      options_.late.of(x_.template cast<double>(),
                       batches_.target(first, count).template cast<double>());
  late_samples_ += count;
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
const Batch<T>& BatchSignal<T>::moved(const Vector<T>& direction, bool linear) {
  SUITE_CHECK(x_bar_.cols() == batches_.size(),
              "products with second derivatives need the batch in one chunk");
  const Batch<T>& out_dot = model_.tangent(direction);
  x_dot_ = out_dot;
  map_->pull_back(x_dot_);
  x_bar_dot_.resizeLike(x_dot_);
  push_tangent(x_dot_, linear, x_bar_dot_);
  map_->pull_back(x_bar_dot_);
  return out_dot;
}

template <class T>
void BatchSignal<T>::hessian_product(const Vector<T>& direction,
                                     Vector<T>& product) {
  const Batch<T>& out_dot = moved(direction, false);
  map_->bend(x_bar_, out_dot, x_bar_dot_);
  model_.backward_tangent(direction, x_bar_, x_bar_dot_, product);
}

template <class T>
void BatchSignal<T>::gauss_newton_product(const Vector<T>& direction,
                                          Vector<T>& product) {
  moved(direction, true);
  product = model_.backward(x_bar_dot_);
}

template <class T>
double BatchSignal<T>::objective() {
  const Index n = batches_.size();
  const Batch<T>& out = model_.forward(batches_.input(0, n));
  x_.resizeLike(out);
  (*map_)(out, batches_.target(0, n), x_);
  Vector<double> loss(n);
  weigh(x_, loss);
  return double(factor_) * loss.sum();
}

template <class T>
void BatchSignal<T>::push_tangent(BatchIn<T>, bool, BatchOut<T>) {
  SUITE_CHECK(false, "this signal has no second derivatives");
}

template <class T>
void BatchSignal<T>::weigh(BatchIn<T>, VectorOut<double>) {
  SUITE_CHECK(false, "this signal has no objective apart from its gradient");
}

template <class T>
void BatchSignal<T>::export_to(Outcome& out) const {
  out.arrays["batch_loss"] = as_row(losses_);
  if (late_samples_ > 0)
    out.arrays["late_error"] = Batch<double>::Constant(
        1, 1, late_ / static_cast<double>(late_samples_));
}

template <class T>
std::size_t BatchSignal<T>::bytes() const {
  const Index numbers = x_.size() + x_bar_.size() + x_dot_.size() +
                        x_bar_dot_.size() + identity_.size() + sum_.size();
  return static_cast<std::size_t>(numbers) * sizeof(T);
}

template class BatchSignal<float>;
template class BatchSignal<double>;

}  // namespace physinv
