#include "suite/nn/resample.h"

#include <algorithm>
#include <array>

#include "suite/nn/activation.h"

namespace physinv::nn {
namespace {

template <class T>
using V = Simd<T, kNarrow>;

Grid doubled(Grid g) { return {2 * g.columns, g.flat() ? 1 : 2 * g.rows}; }

/// Input positions of a pooling cell.
struct Cell {
  std::array<Index, 4> position;
  std::size_t count;
};

Cell cell(Grid grid, Index output) {
  const Index half = grid.columns / 2;
  if (grid.flat()) return {{2 * output, 2 * output + 1, 0, 0}, 2};
  const Index first = output / half * 2 * grid.columns + output % half * 2;
  return {{first, first + 1, first + grid.columns, first + grid.columns + 1},
          4};
}

/// The two sources of output i along an axis of n inputs, with 3/4 and 1/4.
struct Pair {
  Index near, far;
};

Pair sources(Index i, Index n) {
  const Index near = i / 2, far = i % 2 == 0 ? near - 1 : near + 1;
  return {near, std::clamp<Index>(far, 0, n - 1)};
}

}  // namespace

template <class T>
MaxPool<T>::MaxPool(Grid grid, Index channels)
    : Layer<T>(grid.positions() * channels,
               halved(grid).positions() * channels),
      grid_(grid),
      channels_(channels) {}

template <class T>
void MaxPool<T>::forward(const LayerArgs<T>&,
                         Lanes<const T> x,
                         Lanes<T> y) const {
  for (Index i = 0; i < y.rows; ++i) {
    const Cell from = cell(grid_, i / channels_);
    const Index c = i % channels_;
    for (Index j = 0; j < x.width; j += kLanes<T>) {
      V<T> top = load<V<T>>(x.row(from.position[0] * channels_ + c) + j);
      for (std::size_t k = 1; k < from.count; ++k) {
        const V<T> v = load<V<T>>(x.row(from.position[k] * channels_ + c) + j);
        top = ((top >= v) | (top != top)) ? top : v;  // keeps NaN
      }
      store(y.row(i) + j, top);
    }
  }
}

template <class T>
void MaxPool<T>::backward(const LayerArgs<T>&, const Backward<T>& b) const {
  if (!b.x_bar) return;
  for (Index i = 0; i < b.y.rows; ++i) {
    const Cell to = cell(grid_, i / channels_);
    const Index c = i % channels_;
    for (Index j = 0; j < b.x.width; j += kLanes<T>) {
      const V<T> top = load<V<T>>(b.y.row(i) + j);
      V<T> rest = load<V<T>>(b.y_bar.row(i) + j);
      for (std::size_t k = 0; k < to.count; ++k) {
        const Index row = to.position[k] * channels_ + c;
        const auto here = load<V<T>>(b.x.row(row) + j) == top;
        store(b.x_bar.row(row) + j, here ? rest : V<T>{});
        rest = here ? V<T>{} : rest;
      }
    }
  }
  apply_gate(b.gate, b.x_bar);
}

template <class T>
Upsample<T>::Upsample(Grid grid, Index channels)
    : Layer<T>(grid.positions() * channels,
               doubled(grid).positions() * channels),
      grid_(grid),
      channels_(channels) {}

template <class T>
void Upsample<T>::forward(const LayerArgs<T>&,
                          Lanes<const T> x,
                          Lanes<T> y) const {
  const V<T> near = broadcast<V<T>>(T(0.75)), far = broadcast<V<T>>(T(0.25));
  const Grid fine = doubled(grid_);
  const auto row = [&](Index r, Index c, Index channel, Index j) {
    return load<V<T>>(x.row((r * grid_.columns + c) * channels_ + channel) + j);
  };
  for (Index p = 0; p < fine.positions(); ++p) {
    const Pair h = sources(p % fine.columns, grid_.columns);
    const Pair v = sources(p / fine.columns, grid_.rows);
    for (Index c = 0; c < channels_; ++c)
      for (Index j = 0; j < x.width; j += kLanes<T>) {
        const auto along = [&](Index r) {
          return multiply_add<T>(
              far, row(r, h.far, c, j), near * row(r, h.near, c, j));
        };
        V<T> value = along(v.near);
        if (!grid_.flat())
          value = multiply_add<T>(far, along(v.far), near * value);
        store(y.row(p * channels_ + c) + j, value);
      }
  }
}

template <class T>
void Upsample<T>::backward(const LayerArgs<T>&, const Backward<T>& b) const {
  if (!b.x_bar) return;
  const Grid fine = doubled(grid_);
  // Every input gathers from the at most 4 outputs per axis that it is a
  // source of, in order.
  struct Share {
    Index from;
    T weight;
  };
  const auto shares = [](Index i, Index n, Index extent) {
    std::array<Share, 4> all{};
    std::size_t count = 0;
    for (Index o = std::max<Index>(0, 2 * i - 1);
         o <= std::min(extent - 1, 2 * i + 2);
         ++o) {
      const Pair s = sources(o, n);
      const T weight =
          (s.near == i ? T(0.75) : T(0)) + (s.far == i ? T(0.25) : T(0));
      all[count++] = {o, weight};
    }
    return std::pair{all, count};
  };
  const auto only =
      std::pair{std::array<Share, 4>{Share{0, T(1)}}, std::size_t{1}};
  for (Index p = 0; p < grid_.positions(); ++p) {
    const auto [h, hs] = shares(p % grid_.columns, grid_.columns, fine.columns);
    const auto [v, vs] =
        grid_.flat() ? only : shares(p / grid_.columns, grid_.rows, fine.rows);
    for (Index c = 0; c < channels_; ++c)
      for (Index j = 0; j < b.x_bar.width; j += kLanes<T>) {
        V<T> sum{};
        for (std::size_t a = 0; a < vs; ++a)
          for (std::size_t k = 0; k < hs; ++k) {
            const Index from = v[a].from * fine.columns + h[k].from;
            sum = multiply_add<T>(
                broadcast<V<T>>(v[a].weight * h[k].weight),
                load<V<T>>(b.y_bar.row(from * channels_ + c) + j),
                sum);
          }
        store(b.x_bar.row(p * channels_ + c) + j, sum);
      }
  }
  apply_gate(b.gate, b.x_bar);
}

template class MaxPool<float>;
template class MaxPool<double>;
template class Upsample<float>;
template class Upsample<double>;

}  // namespace physinv::nn
