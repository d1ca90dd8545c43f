#include "optimizers/minibatch.h"

#include <algorithm>

#include "optimizers/network_model.h"

namespace physinv {

template <class T>
Minibatch<T>::Minibatch(StageRun& run, Index batch, bool fresh, Index drawn)
    : run_(run),
      problem_(run.oracle.recipe().make<T>()),
      vjp_(dynamic_cast<const Vjp<T>*>(problem_.get())),
      jacobian_(dynamic_cast<const Jacobian<T>*>(problem_.get())),
      projection_(dynamic_cast<const GradientProjection<T>*>(problem_.get())),
      batch_(fresh ? batch : std::min(batch, run.oracle.count())),
      batches_(run.oracle.count() / batch_),
      drawn_(drawn),
      fresh_(fresh),
      y_(run.oracle.shape().observations, batch_),
      y_bar_(y_),
      loss_(batch_),
      tape_(run.threads),
      work_(run.threads) {
  if (!fresh_) load(run.oracle.training(0, batches_ * batch_));
}

template <class T>
void Minibatch<T>::next() {
  if (fresh_) {
    load(run_.oracle.training(drawn_, batch_));
  } else {
    first_ = at_ * batch_;
    at_ = (at_ + 1) % batches_;
  }
  drawn_ += batch_;
}

template <class T>
void Minibatch<T>::load(const Samples<double>& from) {
  target_ = from.y.template cast<T>();
  given_ = from.given.template cast<T>();
  const auto& fields = run_.setting.predictor.inputs;
  for (const Field f : fields)
    SUITE_CHECK(f != Field::unknowns, "a predictor cannot read the unknowns");
  input_ = assemble<T>(fields, from.x, from.given, from.y);
}

template <class T>
void Minibatch<T>::weigh(T factor, Index first, Index count) {
  const auto y = y_.middleCols(first, count);
  const auto target = target_.middleCols(first_ + first, count);
  auto y_bar = y_bar_.middleCols(first, count);
  problem_->loss(y, target, loss_.segment(first, count));
  problem_->loss_gradient(y, target, y_bar);
  y_bar *= factor;
}

template <class T>
void Minibatch<T>::gradient(BatchIn<T> x,
                            T factor,
                            BatchOut<T> x_bar,
                            Index first) {
  const Index n = x.cols();
  vjp_->linearize(
      x, given_.middleCols(first_ + first, n), y_.middleCols(first, n), tape_);
  weigh(factor, first, n);
  vjp_->pullback(tape_, y_bar_.middleCols(first, n), x_bar, work_);
  counts_[Counter::vjp] += static_cast<std::uint64_t>(n);
}

template <class T>
void Minibatch<T>::jacobian(BatchIn<T> x,
                            T factor,
                            bool project,
                            BatchOut<T> j) {
  const auto given = given_.middleCols(first_, batch_);
  problem_->forward(x, given, y_, work_);
  weigh(factor, 0, batch_);
  if (project && projection_ != nullptr) projection_->project(y_, y_bar_);
  jacobian_->jacobian(x, given, j, work_);
  counts_[Counter::jacobian] += static_cast<std::uint64_t>(batch_);
}

template <class T>
Counts Minibatch<T>::counts() const {
  Counts all = counts_;
  all += work_.counts;
  all += tape_.counts;
  return all;
}

template <class T>
std::size_t Minibatch<T>::bytes() const {
  // One batch of the data: the set itself belongs to the problem.
  const Index numbers =
      batch_ * (target_.rows() + given_.rows() + input_.rows()) + y_.size() +
      y_bar_.size();
  return static_cast<std::size_t>(numbers) * sizeof(T) + tape_.bytes() +
         work_.bytes();
}

template class Minibatch<float>;
template class Minibatch<double>;

}  // namespace physinv
