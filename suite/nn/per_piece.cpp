#include "suite/nn/per_piece.h"

#include <algorithm>
#include <utility>

#include "suite/core/check.h"
#include "suite/nn/activation.h"
#include "suite/nn/blocks.h"

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
  each_block(*at.work, pieces_, [&](Index piece, Workspace& work) {
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
void PerPiece<T>::backward(const LayerArgs<T>& at, const Backward<T>& b) const {
  const Workspace::Scope scope(*at.work);
  const Index parts = std::min(kMostParts, pieces_);
  const Index size = b.parameters_bar != nullptr ? parameter_count_ : 0;
  T* const sums = at.work->template take<T>(size, parts).data();
  std::fill_n(sums, size * parts, T(0));
  each_block(*at.work, parts, [&](Index part, Workspace& work) {
    T* const own = work.take<T>(size, 1).data();
    const Index end = pieces_ * (part + 1) / parts;
    for (Index piece = pieces_ * part / parts; piece < end; ++piece) {
      Backward<T> some{.x = part_of(b.x, pieces_, piece),
                       .y = part_of(b.y, pieces_, piece),
                       .y_bar = part_of(b.y_bar, pieces_, piece)};
      if (size > 0) some.parameters_bar = own;
      if (b.x_bar) some.x_bar = part_of(b.x_bar, pieces_, piece);
      if (b.gate.activation != Activation::identity)
        some.gate = {b.gate.activation, part_of(b.gate.y, pieces_, piece)};
      pull(at, some, work);
      for (Index i = 0; i < size; ++i) sums[part * size + i] += own[i];
    }
  });
  if (size == 0) return;
  std::copy_n(sums, size, b.parameters_bar);
  for (Index part = 1; part < parts; ++part)
    for (Index i = 0; i < size; ++i)
      b.parameters_bar[i] += sums[part * size + i];
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
