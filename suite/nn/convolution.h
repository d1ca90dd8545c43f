/// What the convolution layers share: weights [out][in][tap] and biases [out],
/// their pass over all positions and its two reverses.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <vector>

#include "suite/core/threads.h"
#include "suite/nn/conv_kernels.h"
#include "suite/nn/conv_weights.h"
#include "suite/nn/layer.h"

namespace physinv::nn {

/// Sums over positions and samples, one per channel.
template <class T>
void channel_sums(Workspace& work, Rows<const T> x, Index channels, T* sums);

template <class T>
class Convolution {
 public:
  /// `grid` is that of the input.
  Convolution(
      Grid grid, Index in, Index out, const Taps& taps, Padding padding);

  const ConvShape& shape() const { return shape_; }
  Index inputs() const { return input_positions_ * shape_.in; }
  Index outputs() const { return shape_.positions() * shape_.out; }
  Index parameter_count() const { return shape_.weights() + shape_.out; }
  std::vector<TensorInfo> tensors() const;
  double operations() const;

  /// Positions of a block, of one channel count on one side.
  Index per_block(Rows<const T> y) const {
    return positions_per_block<T>(y, shape_.out);
  }
  Index blocks(Rows<const T> y) const {
    const Index some = per_block(y);
    return (shape_.positions() + some - 1) / some;
  }

  /// One of a sum of products, weights [out][in][tap] with x.
  struct Term {
    const T* weights;
    Rows<const T> x;
  };
  /// y = bias + the terms' convolutions, then `done(block, begin, end)` on each
  /// block of positions while it is in the cache. No bias: null.
  template <class F>
  void forward(const Replay<T>& at,
               std::initializer_list<Term> terms,
               const T* bias,
               Rows<T> y,
               F&& done) const;
  /// Of the layer's own weights and biases.
  template <class F>
  void forward(const Replay<T>& at, Rows<const T> x, Rows<T> y, F&& done) const;

  /// Number of partial sums a gradient is added up from: depends on the shape
  /// and the samples, not on the threads.
  Index parts(Index samples) const;
  /// weights_bar and x_bar from y_bar, of which `fill(begin, end)` prepares
  /// positions [begin, end), a multiple of `unit`, just before both read them.
  /// Either may be null.
  template <class F>
  void gradients(const Replay<T>& at,
                 Rows<const T> x,
                 Rows<const T> y_bar,
                 Index unit,
                 T* weights_bar,
                 Rows<T> x_bar,
                 F&& fill) const;

  /// Threads for the pass over this many samples, or null if it is too short.
  Threads* threads(const Replay<T>& at, Index samples) const;

 private:
  struct Pull {
    ConvShape flipped;
    const T* packed;
    Rows<const T> y_bar;
    Rows<T> x_bar;
  };
  void pull(const Pull& at, Index begin, Index end) const;
  void pull_inner(const Pull& at, Index begin, Index end) const;
  template <class First>
  void pull_borders(Threads* threads,
                    const Pull& at,
                    Index unit,
                    Index parts,
                    First&& first) const;

  ConvShape shape_;
  Index input_positions_;
  std::vector<WindowRun> runs_, flipped_runs_;
  /// Outputs of this many first and last positions may be far from their
  /// inputs; the others' largest distance is the reach.
  Index edge_ = 0, reach_ = 0;
};

template <class T>
template <class F>
void Convolution<T>::forward(const Replay<T>& at,
                             Rows<const T> x,
                             Rows<T> y,
                             F&& done) const {
  forward(at, {{at.parameters, x}}, at.parameters + shape_.weights(), y, done);
}

template <class T>
template <class F>
void Convolution<T>::forward(const Replay<T>& at,
                             std::initializer_list<Term> terms,
                             const T* bias,
                             Rows<T> y,
                             F&& done) const {
  const Workspace::Scope scope(*at.work);
  const Index size = shape_.weights();
  T* const packed =
      at.work->template take<T>(size, static_cast<Index>(terms.size())).data();
  T* next = packed;
  for (const Term& term : terms) {
    pack_weights(shape_, term.weights, next);
    next += size;
  }
  const Index per_block = this->per_block(y), blocks = this->blocks(y);
  // Some at once, so that edges of a plane's rows come together.
  Threads* const threads = this->threads(at, y.samples);
  const Index users = threads == nullptr ? 1 : threads->count();
  const Index some = std::clamp(blocks / (2 * users), Index{1}, Index{4});
  for_blocks(threads, (blocks + some - 1) / some, [&](Index group, int) {
    const Index first = group * some, last = std::min(first + some, blocks);
    const Index begin = first * per_block;
    const Index end = std::min(last * per_block, shape_.positions());
    const T* w = packed;
    for (const Term& term : terms) {
      const Into into = w == packed ? Into::nothing : Into::sum;
      convolve<T>(shape_, runs_, w, bias, term.x, y, begin, end, into);
      w += size;
    }
    for (Index b = first; b < last; ++b)
      done(b, b * per_block, std::min((b + 1) * per_block, end));
  });
}

/// x_bar at some positions: a convolution of y_bar with the flipped weights.
template <class T>
void Convolution<T>::pull(const Pull& at, Index begin, Index end) const {
  if (at.x_bar && begin < end)
    convolve<T>(at.flipped,
                flipped_runs_,
                at.packed,
                nullptr,
                at.y_bar,
                at.x_bar,
                begin,
                end);
}

template <class T>
void Convolution<T>::pull_inner(const Pull& at, Index begin, Index end) const {
  pull(at, std::max(begin, edge_), std::min(end, shape_.positions() - edge_));
}

/// What more than one part's outputs have seen, and both ends.
template <class T>
template <class First>
void Convolution<T>::pull_borders(Threads* threads,
                                  const Pull& at,
                                  Index unit,
                                  Index parts,
                                  First&& first) const {
  for_blocks(threads, parts, [&](Index part, int) {
    const Index begin = first(part) * unit, end = first(part + 1) * unit;
    pull_inner(at, begin, std::min(end, begin + reach_));
    pull_inner(at, std::max(begin + reach_, end - reach_), end);
  });
  const Index inner = shape_.positions() - edge_;
  pull(at, 0, std::min(edge_, inner));
  pull(at, std::max(inner, Index{0}), input_positions_);
}

template <class T>
template <class F>
void Convolution<T>::gradients(const Replay<T>& at,
                               Rows<const T> x,
                               Rows<const T> y_bar,
                               Index unit,
                               T* weights_bar,
                               Rows<T> x_bar,
                               F&& fill) const {
  const Workspace::Scope scope(*at.work);
  const Index parts = this->parts(x.samples);
  Threads* const threads = this->threads(at, x.samples);
  const bool in_turn = threads == nullptr || threads->count() == 1;
  std::optional<WeightSums<T>> sums;
  if (weights_bar != nullptr) sums.emplace(shape_, parts, in_turn, *at.work);
  T* packed = nullptr;
  if (x_bar) {
    packed = at.work->template take<T>(shape_.weights(), 1).data();
    pack_flipped(shape_, at.parameters, packed);
  }
  const Pull down{shape_.flipped(), packed, y_bar, x_bar};
  const Index units = shape_.positions() / unit;
  // In the L2: the weights' sums come and go less often. No bits depend on it.
  const Index some = std::max<Index>(1, 4 * per_block(y_bar) / unit);
  const auto first = [&](Index part) { return units * part / parts; };
  for_blocks(threads, parts, [&](Index part, int) {
    const Index last = first(part + 1);
    T* const part_sums = sums ? sums->begin(part) : nullptr;
    // Cotangents of inputs that only this part's outputs have seen.
    Index pulled = first(part) * unit + reach_;
    for (Index u = first(part); u < last; u += some) {
      const Index begin = u * unit, end = std::min(u + some, last) * unit;
      fill(begin, end);
      if (sums)
        accumulate_weights<T>(shape_, runs_, x, y_bar, begin, end, part_sums);
      pull_inner(down, pulled, end - reach_);
      pulled = std::max(pulled, end - reach_);
    }
    if (sums) sums->end(part);
  });
  pull_borders(threads, down, unit, parts, first);
  if (sums) sums->finish(weights_bar);
}

extern template class Convolution<float>;
extern template class Convolution<double>;

}  // namespace physinv::nn
