#include "suite/nn/skip.h"

#include <algorithm>
#include <array>
#include <utility>

#include "suite/core/check.h"
#include "suite/nn/activation.h"

namespace physinv::nn {
namespace {

/// Copies `count` rows per position between fields of different width.
template <class T>
void copy_channels(const LayerArgs<T>& at,
                   Lanes<const T> from,
                   Index from_step,
                   Lanes<T> to,
                   Index to_step,
                   Index count,
                   Index positions) {
  const Index numbers = count * from.stride;
  for_rows(at, positions, numbers, [&](Index begin, Index end) {
    for (Index p = begin; p < end; ++p)
      std::copy_n(from.row(p * from_step), numbers, to.row(p * to_step));
  });
}

template <class T>
Lanes<T> from_row(Lanes<T> x, Index row) {
  x.data += row * x.stride;
  return x;
}

template <class T>
Index outputs_of(const std::vector<std::unique_ptr<Layer<T>>>& layers) {
  SUITE_CHECK(!layers.empty(), "a skip connection leads around something");
  return layers.front()->inputs() + layers.back()->outputs();
}

}  // namespace

template <class T>
Skip<T>::Skip(Index positions, Layers inner)
    : Layer<T>(inner.empty() ? 0 : inner.front()->inputs(), outputs_of(inner)),
      positions_(positions),
      inner_(std::move(inner)) {
  Index parameters = 0, size = this->inputs();
  slots_ = inner_.size();
  for (const auto& layer : inner_) {
    SUITE_CHECK(layer->inputs() == size, "neighbouring layers differ in size");
    size = layer->outputs();
    widest_ = std::max({widest_, layer->inputs(), size});
    places_.push_back({parameters, state_count_, slots_});
    for (const TensorInfo& t : layer->tensors()) parameters += t.size;
    state_count_ += layer->state_count();
    slots_ += layer->slots();
  }
  SUITE_CHECK(this->inputs() % positions == 0 && size % positions == 0,
              "a skip connection joins fields on one grid");
}

template <class T>
std::vector<TensorInfo> Skip<T>::tensors() const {
  std::vector<TensorInfo> all;
  for (const auto& layer : inner_)
    for (TensorInfo& t : layer->tensors()) all.push_back(std::move(t));
  return all;
}

template <class T>
void Skip<T>::initialize_state(T* state) const {
  for (std::size_t i = 0; i < inner_.size(); ++i)
    inner_[i]->initialize_state(state + places_[i].state);
}

template <class T>
LayerArgs<T> Skip<T>::args(const LayerArgs<T>& at, std::size_t i) const {
  LayerArgs<T> inner = at;
  inner.parameters = at.parameters + places_[i].parameters;
  if (at.parameters_dot != nullptr)
    inner.parameters_dot = at.parameters_dot + places_[i].parameters;
  if (at.state != nullptr) inner.state = at.state + places_[i].state;
  inner.slot = at.slot + places_[i].slot;
  inner.leading = inner.trailing = 0;
  return inner;
}

template <class T>
void Skip<T>::forward(const LayerArgs<T>& at,
                      Lanes<const T> x,
                      Lanes<T> y) const {
  const Index own = this->inputs() / positions_;
  const Index all = this->outputs() / positions_;
  copy_channels<T>(at, x, own, y, all, own, positions_);
  Lanes<const T> from = x;
  for (std::size_t i = 0; i < inner_.size(); ++i) {
    Lanes<T> to(nullptr, inner_[i]->outputs(), x.samples);
    to.data = at.tape->template slot<T>(at.slot + i, to.stride, to.rows).data();
    inner_[i]->forward(args(at, i), from, to);
    from = to;
  }
  copy_channels<T>(
      at, from, all - own, from_row(y, own), all, all - own, positions_);
}

template <class T>
void Skip<T>::backward(const LayerArgs<T>& at, const Backward<T>& b) const {
  using V = NarrowPack<T>;
  const Index own = this->inputs() / positions_;
  const Index all = this->outputs() / positions_;
  const Index n = b.x.samples, stride = b.x.stride;
  const Workspace::Scope scope(*at.work);
  T* free = at.work->template take<T>(stride, widest_).data();
  Lanes<T> y_bar(at.work->template take<T>(stride, widest_).data(),
                 inner_.back()->outputs(),
                 n);
  copy_channels<T>(
      at, from_row(b.y_bar, own), all, y_bar, all - own, all - own, positions_);
  const auto kept = [&](std::size_t i) -> Lanes<const T> {
    return this->kept(*at.tape, at.slot, i, n);
  };
  for (std::size_t i = inner_.size(); i-- > 0;) {
    Backward<T> inner{
        .x = i > 0 ? kept(i - 1) : b.x, .y = kept(i), .y_bar = y_bar};
    if (b.parameters_bar != nullptr)
      inner.parameters_bar = b.parameters_bar + places_[i].parameters;
    if (i > 0 || b.x_bar) inner.x_bar = {free, inner_[i]->inputs(), n};
    if (i > 0) inner.gate = {inner_[i - 1]->fused(), inner.x};
    inner_[i]->backward(args(at, i), inner);
    free = y_bar.data;
    y_bar = inner.x_bar;
  }
  if (!b.x_bar) return;
  for_rows(at, positions_, own * stride, [&](Index begin, Index end) {
    for (Index p = begin; p < end; ++p)
      for (Index c = 0; c < own; ++c)
        for (Index j = 0; j < b.x_bar.width; j += kNarrowLanes<T>)
          store(b.x_bar.row(p * own + c) + j,
                load<V>(b.y_bar.row(p * all + c) + j) +
                    load<V>(y_bar.row(p * own + c) + j));
  });
  apply_gate(b.gate, b.x_bar);
}

template <class T>
Lanes<T> Skip<T>::kept(const Tape& tape,
                       std::size_t slot,
                       std::size_t i,
                       Index samples) const {
  return {tape.view<T>(slot + i).data(), inner_[i]->outputs(), samples};
}

template <class T>
void Skip<T>::tangent(const LayerArgs<T>& at, const Tangent<T>& t) const {
  const Index own = this->inputs() / positions_, n = t.x.samples;
  const Index all = this->outputs() / positions_;
  copy_channels<T>(at, t.x_dot, own, t.y_dot, all, own, positions_);
  Tangent<T> inner{.x = t.x, .x_dot = t.x_dot};
  for (std::size_t i = 0; i < inner_.size(); ++i) {
    inner.y = kept(*at.tape, at.slot, i, n);
    at.dots->template slot<T>(at.slot + i, inner.y.stride, inner.y.rows);
    inner.y_dot = kept(*at.dots, at.slot, i, n);
    inner_[i]->tangent(args(at, i), inner);
    inner.x = inner.y, inner.x_dot = inner.y_dot;
  }
  copy_channels<T>(at,
                   inner.x_dot,
                   all - own,
                   from_row(t.y_dot, own),
                   all,
                   all - own,
                   positions_);
}

template <class T>
void Skip<T>::backward_tangent(const LayerArgs<T>& at,
                               const BackwardTangent<T>& b) const {
  const Index own = this->inputs() / positions_, n = b.x.samples;
  const Index all = this->outputs() / positions_;
  const Workspace::Scope scope(*at.work);
  std::array<Lanes<T>, 4> bars;
  for (Lanes<T>& bar : bars) {
    bar = {nullptr, widest_, n};
    bar.data = at.work->template take<T>(bar.stride, bar.rows).data();
  }
  auto& [y_bar, y_bar_dot, x_bar, x_bar_dot] = bars;
  const auto take_in = [&](Lanes<const T> whole, Lanes<T> part) {
    copy_channels<T>(
        at, from_row(whole, own), all, part, all - own, all - own, positions_);
  };
  take_in(b.y_bar, y_bar), take_in(b.y_bar_dot, y_bar_dot);
  for (std::size_t i = inner_.size(); i-- > 0;) {
    y_bar.rows = y_bar_dot.rows = inner_[i]->outputs();
    x_bar.rows = x_bar_dot.rows = inner_[i]->inputs();
    BackwardTangent<T> inner{
        .x = i > 0 ? kept(*at.tape, at.slot, i - 1, n) : b.x,
        .y = kept(*at.tape, at.slot, i, n),
        .x_dot = i > 0 ? kept(*at.dots, at.slot, i - 1, n) : b.x_dot,
        .y_dot = kept(*at.dots, at.slot, i, n),
        .y_bar = y_bar,
        .y_bar_dot = y_bar_dot};
    const Index place = places_[i].parameters;
    if (b.parameters_bar != nullptr)
      inner.parameters_bar = b.parameters_bar + place;
    inner.parameters_bar_dot = b.parameters_bar_dot + place;
    if (i > 0 || b.x_bar) inner.x_bar = x_bar, inner.x_bar_dot = x_bar_dot;
    inner_[i]->backward_tangent(args(at, i), inner);
    if (i > 0)
      apply_gate_tangent<T>(
          {inner_[i - 1]->fused(), inner.x}, inner.x_dot, x_bar, x_bar_dot);
    std::swap(y_bar, x_bar), std::swap(y_bar_dot, x_bar_dot);
  }
  if (!b.x_bar) return;
  const auto join = [&](Lanes<const T> whole, Lanes<T> part, Lanes<T> to) {
    copy_channels<T>(at, whole, all, to, own, own, positions_);
    part.rows = to.rows;
    add_lanes<T>(part, to);
  };
  join(b.y_bar, y_bar, b.x_bar), join(b.y_bar_dot, y_bar_dot, b.x_bar_dot);
}

template <class T>
void Skip<T>::update_state(const Tape& tape, std::size_t slot, T* state) const {
  for (std::size_t i = 0; i < inner_.size(); ++i)
    inner_[i]->update_state(
        tape, slot + places_[i].slot, state + places_[i].state);
}

template <class T>
double Skip<T>::operations() const {
  double sum = 0;
  for (const auto& layer : inner_) sum += layer->operations();
  return sum;
}

template class Skip<float>;
template class Skip<double>;

}  // namespace physinv::nn
