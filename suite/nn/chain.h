/// Layers one after the other: what a network (sequential.h) and the layers
/// around other layers (skip.h, per_piece.h) share.
///
/// Passes ask their caller where the outputs are: y(i) are those of layer i,
/// y_dot(i) their derivatives. On a tape they are the first slots, in front of
/// the layers' own: `opened` and `kept`.
#pragma once

#include <cstddef>
#include <vector>

#include "suite/nn/activation.h"
#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
class Bars;

template <class T>
class Chain {
 public:
  /// At least one layer; sizes must fit each other.
  explicit Chain(Layers<T> layers);

  std::size_t size() const { return layers_.size(); }
  const Layer<T>& operator[](std::size_t i) const { return *layers_[i]; }
  Index inputs() const { return layers_.front()->inputs(); }
  Index outputs() const { return layers_.back()->outputs(); }
  /// Most features of a layer's input and output together.
  Index widest_pair() const { return widest_pair_; }
  Index parameter_count() const { return parameter_count_; }
  Index state_count() const { return state_count_; }
  /// Of the outputs, then of the layers themselves.
  std::size_t slots() const { return slots_; }
  /// Leading layers without parameters or state.
  std::size_t prefix() const { return prefix_; }
  /// In memory order; kind, size and fan_in are set.
  std::vector<TensorInfo> tensors() const;
  void initialize_state(T* state) const;
  void update_state(const Tape& tape, std::size_t slot, T* state) const;
  double operations() const;

  /// y for a tape on which the chain's slots start at `slot`.
  auto opened(Tape& tape, std::size_t slot, Index samples) const {
    return [=, this, &tape](std::size_t i) {
      return open_rows<T>(tape, slot + i, layers_[i]->outputs(), samples);
    };
  }
  auto kept(const Tape& tape, std::size_t slot, Index samples) const {
    return [=, this, &tape](std::size_t i) {
      return kept_rows<T>(tape, slot + i, layers_[i]->outputs(), samples);
    };
  }

  /// First of the parameters of layer i.
  Index parameters(std::size_t i) const { return places_[i].parameters; }
  /// `at` for layer i. Constant rows are those of the first layer behind the
  /// prefix.
  Replay<T> within(const Replay<T>& at, std::size_t i) const;

  /// Layers [first, last), x the input of the first.
  template <class Y>
  void forward(const Run<T>& at,
               Rows<const T> x,
               std::size_t first,
               std::size_t last,
               Y&& y) const {
    for (std::size_t i = first; i < last; ++i) {
      const Rows<T> to = y(i);
      layers_[i]->forward(
          {within(at, i), *at.tape, at.state + places_[i].state}, x, to);
      x = to;
    }
  }
  /// From the output down to layer `first`; b is a step of all the layers but
  /// for its y.
  template <class Y>
  void backward(const Replay<T>& at,
                const Backward<T>& b,
                std::size_t first,
                Y&& y,
                const Bars<T>& bars) const {
    Backward<T> step = b;
    for (std::size_t i = size(); i-- > first;) {
      step.x = i > 0 ? Rows<const T>(y(i - 1)) : b.x, step.y = y(i);
      if (b.parameters_bar != nullptr)
        step.parameters_bar = b.parameters_bar + places_[i].parameters;
      if (i > first) {
        step.x_bar = bars(i), step.gate = {layers_[i - 1]->fused(), step.x};
      } else {
        step.x_bar = b.x_bar, step.gate = b.gate;
      }
      layers_[i]->backward(within(at, i), step);
      step.y_bar = step.x_bar;
    }
  }
  /// Layers [first, last); t without y and y_dot.
  template <class Y, class YDot>
  void tangent(const Replay<T>& at,
               Tangent<T> t,
               std::size_t first,
               std::size_t last,
               Y&& y,
               YDot&& y_dot) const {
    const T* const direction = t.parameters_dot;
    for (std::size_t i = first; i < last; ++i) {
      t.y = y(i), t.y_dot = y_dot(i);
      t.parameters_dot = direction + places_[i].parameters;
      layers_[i]->tangent(within(at, i), t);
      t.x = t.y, t.x_dot = t.y_dot;
    }
  }
  /// As `backward`; b without y and y_dot.
  template <class Y, class YDot>
  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b,
                        std::size_t first,
                        Y&& y,
                        YDot&& y_dot,
                        const Bars<T>& bars,
                        const Bars<T>& bars_dot) const {
    BackwardTangent<T> step = b;
    for (std::size_t i = size(); i-- > first;) {
      const Index place = places_[i].parameters;
      step.x = i > 0 ? Rows<const T>(y(i - 1)) : b.x, step.y = y(i);
      step.x_dot = i > 0 ? Rows<const T>(y_dot(i - 1)) : b.x_dot;
      step.y_dot = y_dot(i);
      step.parameters_dot = b.parameters_dot + place;
      if (b.parameters_bar != nullptr)
        step.parameters_bar = b.parameters_bar + place;
      step.parameters_bar_dot = b.parameters_bar_dot + place;
      step.x_bar = i > first ? bars(i) : b.x_bar;
      step.x_bar_dot = i > first ? bars_dot(i) : b.x_bar_dot;
      layers_[i]->backward_tangent(within(at, i), step);
      if (i > first)
        apply_gate_tangent<T>({layers_[i - 1]->fused(), step.x},
                              step.x_dot,
                              step.x_bar,
                              step.x_bar_dot);
      step.y_bar = step.x_bar, step.y_bar_dot = step.x_bar_dot;
    }
  }

 private:
  /// Where a layer's numbers are, relative to the chain's.
  struct Place {
    Index parameters = 0, state = 0;
    std::size_t slot = 0;
  };

  Layers<T> layers_;
  std::vector<Place> places_;
  Index parameter_count_ = 0, state_count_ = 0, widest_pair_ = 0;
  std::size_t slots_ = 0, prefix_ = 0;
};

/// Memory of cotangents on their way down a chain: (i) is the cotangent of the
/// input of layer i, (size()) that of the output. A step back needs those of
/// one layer, so that they lie at the two ends of one array in turn.
template <class T>
class Bars {
 public:
  Bars(const Chain<T>& chain, Index samples, Workspace& work)
      : chain_(chain), samples_(samples) {
    const Rows<T> rows(nullptr, chain.widest_pair(), samples);
    size_ = round_up(rows.rows * rows.stride, kLine) + kLine;
    data_ = work.take<T>(size_, 1).data();
  }
  Rows<T> operator()(std::size_t i) const {
    const bool last = i == chain_.size();
    Rows<T> bar(data_, last ? chain_.outputs() : chain_[i].inputs(), samples_);
    if (i % 2 != 0) bar.data += size_ - round_up(bar.rows * bar.stride, kLine);
    return bar;
  }

 private:
  static constexpr Index kLine = kAlignment / sizeof(T);

  const Chain<T>& chain_;
  Index samples_, size_;
  T* data_;
};

}  // namespace physinv::nn
