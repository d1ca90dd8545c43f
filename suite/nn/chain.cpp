#include "suite/nn/chain.h"

#include <algorithm>
#include <utility>

#include "suite/core/check.h"

namespace physinv::nn {

template <class T>
Chain<T>::Chain(Layers<T> layers)
    : layers_(std::move(layers)), slots_(layers_.size()) {
  SUITE_CHECK(!layers_.empty(), "a network must have at least one layer");
  Index size = inputs();
  for (const auto& layer : layers_) {
    SUITE_CHECK(layer->inputs() == size,
                "a layer's inputs must match the outputs of the layer before");
    widest_pair_ = std::max(widest_pair_, size + layer->outputs());
    size = layer->outputs();
    places_.push_back({parameter_count_, state_count_, slots_});
    for (const TensorInfo& t : layer->tensors()) parameter_count_ += t.size;
    state_count_ += layer->state_count();
    slots_ += layer->slots();
    if (parameter_count_ == 0 && state_count_ == 0) ++prefix_;
  }
}

template <class T>
std::vector<TensorInfo> Chain<T>::tensors() const {
  std::vector<TensorInfo> all;
  for (const auto& layer : layers_)
    for (TensorInfo& t : layer->tensors()) all.push_back(std::move(t));
  return all;
}

template <class T>
void Chain<T>::initialize_state(T* state) const {
  for (std::size_t i = 0; i < size(); ++i)
    layers_[i]->initialize_state(state + places_[i].state);
}

template <class T>
void Chain<T>::update_state(const Tape& tape,
                            std::size_t slot,
                            T* state) const {
  for (std::size_t i = 0; i < size(); ++i)
    layers_[i]->update_state(
        tape, slot + places_[i].slot, state + places_[i].state);
}

template <class T>
double Chain<T>::operations() const {
  double sum = 0;
  for (const auto& layer : layers_) sum += layer->operations();
  return sum;
}

template <class T>
Replay<T> Chain<T>::within(const Replay<T>& at, std::size_t i) const {
  Replay<T> inner = at;
  inner.parameters += places_[i].parameters;
  inner.slot += places_[i].slot;
  if (i != prefix_) inner.leading = inner.trailing = 0;
  return inner;
}

template class Chain<float>;
template class Chain<double>;

}  // namespace physinv::nn
