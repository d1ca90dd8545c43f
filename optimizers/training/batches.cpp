#include "optimizers/training/batches.h"

#include <algorithm>

#include "optimizers/network_model.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/core/whole.h"

namespace physinv {

Index drawn_before(const StageRun& run) {
  if (run.previous == nullptr) return 0;
  const auto found = run.previous->arrays.find("samples_drawn");
  return found == run.previous->arrays.end()
             ? 0
             : whole_part<Index>(found->second(0, 0));
}

namespace {

Index set_size(const StageRun& run, const BatchOptions& options) {
  return options.set > 0 ? options.set : run.oracle.count();
}

}  // namespace

template <class T>
Batches<T>::Batches(StageRun& run, const BatchOptions& options, Index drawn)
    : run_(run),
      size_(options.fresh ? options.size
                          : std::min(options.size, set_size(run, options))),
      slices_(set_size(run, options) / size_),
      drawn_(drawn),
      fresh_(options.fresh) {
  if (!fresh_) load(0, slices_ * size_);
}

template <class T>
void Batches<T>::keep_exact() {
  exact_ = true;
  if (!fresh_) load(0, slices_ * size_);
}

template <class T>
void Batches<T>::keep_labels() {
  labelled_ = true;
  if (!fresh_) load(0, slices_ * size_);
}

template <class T>
void Batches<T>::next() {
  if (fresh_) {
    const Probe::Aside aside = run_.probe.drawing();
    load(drawn_, size_);
  } else {
    first_ = at_ * size_;
    at_ = (at_ + 1) % slices_;
  }
  drawn_ += size_;
}

template <class T>
void Batches<T>::load(Index first, Index count) {
  const Samples<double> from = labelled_ ? run_.oracle.labelled(first, count)
                                         : run_.oracle.training(first, count);
  target_ = from.y.template cast<T>();
  if (exact_) exact_target_ = from.y;
  if (labelled_) label_ = from.x.template cast<T>();
  given_ = from.given.template cast<T>();
  const auto& fields = run_.setting.predictor.inputs;
  for (const Field f : fields)
    SUITE_CHECK(f != Field::unknowns, "a predictor cannot read the unknowns");
  input_ = assemble<T>(fields, from.x, from.given, from.y);
}

template <class T>
std::size_t Batches<T>::bytes() const {
  const Index numbers =
      size_ * (target_.rows() + given_.rows() + input_.rows() + label_.rows());
  return static_cast<std::size_t>(numbers) * sizeof(T) +
         static_cast<std::size_t>(exact_target_.size()) * sizeof(double);
}

template class Batches<float>;
template class Batches<double>;

}  // namespace physinv
