#include "suite/nn/per_piece.h"

#include <algorithm>
#include <array>
#include <utility>

#include "suite/core/blocks.h"
#include "suite/core/check.h"
#include "suite/nn/activation.h"

namespace physinv::nn {
namespace {

constexpr Index kMostParts = 8;  ///< partial sums of a gradient

template <class T>
Index all_outputs(Index pieces,
                  const std::vector<std::unique_ptr<Layer<T>>>& l) {
  SUITE_CHECK(!l.empty(), "a piece goes through at least one layer");
  return pieces * l.back()->outputs();
}

template <class T>
Lanes<T> part_of(Lanes<T> x, Index pieces, Index piece) {
  const Index rows = x.rows / pieces;
  return {x.data + piece * rows * x.stride, rows, x.samples};
}

}  // namespace

template <class T>
PerPiece<T>::PerPiece(Index pieces, Layers inner)
    : Layer<T>(inner.empty() ? 0 : pieces * inner.front()->inputs(),
               all_outputs(pieces, inner)),
      pieces_(pieces),
      inner_(std::move(inner)) {
  Index size = inner_.front()->inputs();
  for (const auto& layer : inner_) {
    SUITE_CHECK(layer->inputs() == size, "neighbouring layers differ in size");
    SUITE_CHECK(layer->slots() == 0 && layer->state_count() == 0,
                "a piece's layers remember nothing");
    size = layer->outputs();
    widest_ = std::max({widest_, layer->inputs(), size});
    parameters_.push_back(parameter_count_);
    for (const TensorInfo& t : layer->tensors()) parameter_count_ += t.size;
  }
}

template <class T>
std::vector<TensorInfo> PerPiece<T>::tensors() const {
  std::vector<TensorInfo> all;
  for (const auto& layer : inner_)
    for (TensorInfo& t : layer->tensors()) all.push_back(std::move(t));
  return all;
}

template <class T>
LayerArgs<T> PerPiece<T>::args(const LayerArgs<T>& at,
                               std::size_t i,
                               Workspace& work) const {
  LayerArgs<T> inner = at;
  inner.parameters = at.parameters + parameters_[i];
  if (at.parameters_dot != nullptr)
    inner.parameters_dot = at.parameters_dot + parameters_[i];
  inner.work = &work;
  inner.leading = inner.trailing = 0;
  return inner;
}

template <class T>
std::vector<Lanes<T>> PerPiece<T>::run(const LayerArgs<T>& at,
                                       Lanes<const T> x,
                                       Lanes<T> y,
                                       Workspace& work) const {
  std::vector<Lanes<T>> outputs;
  for (std::size_t i = 0; i < inner_.size(); ++i) {
    if (i + 1 == inner_.size()) {
      if (y) inner_[i]->forward(args(at, i, work), x, y);
      outputs.push_back(y);
      break;
    }
    Lanes<T> to(nullptr, inner_[i]->outputs(), x.samples);
    to.data = work.take<T>(to.stride, to.rows).data();
    inner_[i]->forward(args(at, i, work), x, to);
    outputs.push_back(to);
    x = to;
  }
  return outputs;
}

template <class T>
void PerPiece<T>::forward(const LayerArgs<T>& at,
                          Lanes<const T> x,
                          Lanes<T> y) const {
  for_blocks(*at.work, pieces_, [&](Index piece, Workspace& work) {
    run(at, part_of(x, pieces_, piece), part_of(y, pieces_, piece), work);
  });
}

template <class T>
void PerPiece<T>::pull(const LayerArgs<T>& at,
                       const Backward<T>& b,
                       Workspace& work) const {
  const Workspace::Scope scope(work);
  const Index n = b.x.samples;
  const auto outputs = run(at, b.x, {}, work);
  T* free[2];
  for (T*& some : free)
    some = work.take<T>(Lanes<T>(nullptr, 1, n).stride, widest_).data();
  Lanes<const T> y_bar = b.y_bar;
  for (std::size_t i = inner_.size(); i-- > 0;) {
    Backward<T> inner{
        .x = i > 0 ? Lanes<const T>(outputs[i - 1]) : b.x,
        .y = i + 1 < inner_.size() ? Lanes<const T>(outputs[i]) : b.y,
        .y_bar = y_bar};
    if (b.parameters_bar != nullptr)
      inner.parameters_bar = b.parameters_bar + parameters_[i];
    if (i > 0) {
      inner.x_bar = {free[i % 2], inner_[i]->inputs(), n};
      inner.gate = {inner_[i - 1]->fused(), inner.x};
    } else {
      inner.x_bar = b.x_bar, inner.gate = b.gate;
    }
    inner_[i]->backward(args(at, i, work), inner);
    y_bar = inner.x_bar;
  }
}

template <class T>
template <class F>
void PerPiece<T>::sum_pieces(Workspace& work,
                             Index size,
                             T* bars,
                             F&& step) const {
  const Workspace::Scope scope(work);
  const Index parts = std::min(kMostParts, pieces_);
  T* const sums = work.take<T>(size, parts).data();
  std::fill_n(sums, size * parts, T(0));
  for_blocks(work, parts, [&](Index part, Workspace& some) {
    T* const own = some.take<T>(size, 1).data();
    const Index end = pieces_ * (part + 1) / parts;
    for (Index piece = pieces_ * part / parts; piece < end; ++piece) {
      step(piece, own, some);
      for (Index i = 0; i < size; ++i) sums[part * size + i] += own[i];
    }
  });
  if (size == 0) return;
  std::copy_n(sums, size, bars);
  for (Index part = 1; part < parts; ++part)
    for (Index i = 0; i < size; ++i) bars[i] += sums[part * size + i];
}

template <class T>
void PerPiece<T>::backward(const LayerArgs<T>& at, const Backward<T>& b) const {
  const Index size = b.parameters_bar != nullptr ? parameter_count_ : 0;
  sum_pieces(
      *at.work,
      size,
      b.parameters_bar,
      [&](Index piece, T* own, Workspace& work) {
        Backward<T> some{.x = part_of(b.x, pieces_, piece),
                         .y = part_of(b.y, pieces_, piece),
                         .y_bar = part_of(b.y_bar, pieces_, piece)};
        if (size > 0) some.parameters_bar = own;
        if (b.x_bar) some.x_bar = part_of(b.x_bar, pieces_, piece);
        if (b.gate.activation != Activation::identity)
          some.gate = {b.gate.activation, part_of(b.gate.y, pieces_, piece)};
        pull(at, some, work);
      });
}

template <class T>
std::vector<Lanes<T>> PerPiece<T>::push(const LayerArgs<T>& at,
                                        const std::vector<Lanes<T>>& outputs,
                                        Tangent<T> t,
                                        Workspace& work) const {
  std::vector<Lanes<T>> dots;
  const Lanes<const T> y = t.y;
  const Lanes<T> last = t.y_dot;
  for (std::size_t i = 0; i < inner_.size(); ++i) {
    const bool end = i + 1 == inner_.size();
    t.y = end ? y : Lanes<const T>(outputs[i]);
    t.y_dot = last;
    if (!end) {
      t.y_dot = {nullptr, inner_[i]->outputs(), t.x.samples};
      t.y_dot.data = work.take<T>(t.y_dot.stride, t.y_dot.rows).data();
    }
    if (t.y_dot) inner_[i]->tangent(args(at, i, work), t);
    dots.push_back(t.y_dot);
    t.x = t.y, t.x_dot = t.y_dot;
  }
  return dots;
}

template <class T>
void PerPiece<T>::tangent(const LayerArgs<T>& at, const Tangent<T>& t) const {
  for_blocks(*at.work, pieces_, [&](Index piece, Workspace& work) {
    const Lanes<const T> x = part_of(t.x, pieces_, piece);
    push(at,
         run(at, x, {}, work),
         {.x = x,
          .y = part_of(t.y, pieces_, piece),
          .x_dot = part_of(t.x_dot, pieces_, piece),
          .y_dot = part_of(t.y_dot, pieces_, piece)},
         work);
  });
}

template <class T>
void PerPiece<T>::pull_tangent(const LayerArgs<T>& at,
                               const BackwardTangent<T>& b,
                               Workspace& work) const {
  const Workspace::Scope scope(work);
  const auto outputs = run(at, b.x, {}, work);
  const auto dots =
      push(at, outputs, {.x = b.x, .y = b.y, .x_dot = b.x_dot}, work);
  std::array<Lanes<T>, 4> bars;
  for (Lanes<T>& bar : bars) {
    bar = {nullptr, widest_, b.x.samples};
    bar.data = work.take<T>(bar.stride, bar.rows).data();
  }
  auto& [y_bar, y_bar_dot, x_bar, x_bar_dot] = bars;
  BackwardTangent<T> inner = b;
  for (std::size_t i = inner_.size(); i-- > 0;) {
    inner.x = i > 0 ? Lanes<const T>(outputs[i - 1]) : b.x;
    inner.x_dot = i > 0 ? Lanes<const T>(dots[i - 1]) : b.x_dot;
    if (b.parameters_bar != nullptr)
      inner.parameters_bar = b.parameters_bar + parameters_[i];
    inner.parameters_bar_dot = b.parameters_bar_dot + parameters_[i];
    x_bar.rows = x_bar_dot.rows = inner_[i]->inputs();
    inner.x_bar = i > 0 ? x_bar : b.x_bar;
    inner.x_bar_dot = i > 0 ? x_bar_dot : b.x_bar_dot;
    inner_[i]->backward_tangent(args(at, i, work), inner);
    if (i > 0)
      apply_gate_tangent<T>(
          {inner_[i - 1]->fused(), inner.x}, inner.x_dot, x_bar, x_bar_dot);
    std::swap(y_bar, x_bar), std::swap(y_bar_dot, x_bar_dot);
    inner.y = inner.x, inner.y_dot = inner.x_dot;
    inner.y_bar = y_bar, inner.y_bar_dot = y_bar_dot;
  }
}

template <class T>
void PerPiece<T>::backward_tangent(const LayerArgs<T>& at,
                                   const BackwardTangent<T>& b) const {
  const Index size = parameter_count_;
  const Workspace::Scope scope(*at.work);
  T* const sums = at.work->template take<T>(2 * size, 1).data();
  const bool first = b.parameters_bar != nullptr;
  sum_pieces(
      *at.work, 2 * size, sums, [&](Index piece, T* own, Workspace& work) {
        const auto part = [&](auto lanes) {
          return lanes ? part_of(lanes, pieces_, piece) : lanes;
        };
        std::fill_n(own, size, T(0));
        pull_tangent(at,
                     {.x = part(b.x),
                      .y = part(b.y),
                      .x_dot = part(b.x_dot),
                      .y_dot = part(b.y_dot),
                      .y_bar = part(b.y_bar),
                      .y_bar_dot = part(b.y_bar_dot),
                      .parameters_bar = first ? own : nullptr,
                      .parameters_bar_dot = own + size,
                      .x_bar = part(b.x_bar),
                      .x_bar_dot = part(b.x_bar_dot)},
                     work);
      });
  if (first) std::copy_n(sums, size, b.parameters_bar);
  std::copy_n(sums + size, size, b.parameters_bar_dot);
}

template <class T>
double PerPiece<T>::operations() const {
  double sum = 0;
  for (const auto& layer : inner_) sum += layer->operations();
  return sum * static_cast<double>(pieces_);
}

template class PerPiece<float>;
template class PerPiece<double>;

}  // namespace physinv::nn
