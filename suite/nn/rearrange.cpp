#include "suite/nn/rearrange.h"

#include <algorithm>

#include "suite/nn/activation.h"

namespace physinv::nn {
namespace {

template <class T>
using V = NarrowPack<T>;

template <class T>
void copy_row(const T* from, Index width, T* to) {
  std::copy(from, from + width, to);
}

}  // namespace

template <class T>
FieldInput<T>::FieldInput(const FieldInputOptions& o)
    : PiecewiseLinear<T>(o.inputs(), o.positions * o.width()), o_(o) {}

template <class T>
void FieldInput<T>::forward(const LayerArgs<T>&,
                            Lanes<const T> x,
                            Lanes<T> y) const {
  const V<T> shift = broadcast<V<T>>(static_cast<T>(o_.shift));
  const V<T> unit = broadcast<V<T>>(static_cast<T>(o_.unit));
  const auto spread = [&](Index from, Index channel) {
    T* const first = y.row(channel);
    for (Index j = 0; j < x.width; j += kNarrowLanes<T>)
      store(first + j, (load<V<T>>(x.row(from) + j) - shift) / unit);
    for (Index p = 1; p < o_.positions; ++p)
      copy_row(first, x.width, y.row(p * o_.width() + channel));
  };
  for (Index c = 0; c < o_.before; ++c) spread(c, c);
  for (Index c = 0; c < o_.channels; ++c)
    for (Index p = 0; p < o_.positions; ++p) {
      T* const to = y.row(p * o_.width() + o_.before + c);
      if (p % o_.columns < o_.hidden) {
        std::fill_n(to, x.width, T(0));
      } else {
        copy_row(x.row(o_.before + c * o_.positions + p), x.width, to);
      }
    }
  for (Index c = 0; c < o_.after; ++c)
    spread(o_.inputs() - o_.after + c, o_.width() - o_.after + c);
}

template <class T>
void FieldInput<T>::backward(const LayerArgs<T>&, const Backward<T>& b) const {
  if (!b.x_bar) return;
  const V<T> unit = broadcast<V<T>>(static_cast<T>(o_.unit));
  const Index width = b.x_bar.width;
  const auto collect = [&](Index to, Index channel) {
    for (Index j = 0; j < width; j += kNarrowLanes<T>) {
      V<T> sum{};
      for (Index p = 0; p < o_.positions; ++p)
        sum += load<V<T>>(b.y_bar.row(p * o_.width() + channel) + j);
      store(b.x_bar.row(to) + j, sum / unit);
    }
  };
  for (Index c = 0; c < o_.before; ++c) collect(c, c);
  for (Index c = 0; c < o_.channels; ++c)
    for (Index p = 0; p < o_.positions; ++p) {
      T* const to = b.x_bar.row(o_.before + c * o_.positions + p);
      if (p % o_.columns < o_.hidden) {
        std::fill_n(to, width, T(0));
      } else {
        copy_row(b.y_bar.row(p * o_.width() + o_.before + c), width, to);
      }
    }
  for (Index c = 0; c < o_.after; ++c)
    collect(o_.inputs() - o_.after + c, o_.width() - o_.after + c);
  apply_gate(b.gate, b.x_bar);
}

template <class T>
void FieldInput<T>::tangent(const LayerArgs<T>& at, const Tangent<T>& t) const {
  FieldInputOptions linear = o_;
  linear.shift = 0;
  FieldInput(linear).forward(at, t.x_dot, t.y_dot);
}

template <class T>
void Coordinates<T>::forward(const LayerArgs<T>&,
                             Lanes<const T> x,
                             Lanes<T> y) const {
  const auto share = [](Index i, Index count) {
    return static_cast<T>(double(i) / double(std::max<Index>(count - 1, 1)));
  };
  for (Index p = 0; p < grid_.positions(); ++p) {
    copy_row(x.row(p), x.width, y.row(3 * p));
    std::fill_n(
        y.row(3 * p + 1), x.width, share(p / grid_.columns, grid_.rows));
    std::fill_n(
        y.row(3 * p + 2), x.width, share(p % grid_.columns, grid_.columns));
  }
}

template <class T>
void Coordinates<T>::backward(const LayerArgs<T>&, const Backward<T>& b) const {
  if (!b.x_bar) return;
  for (Index p = 0; p < grid_.positions(); ++p)
    copy_row(b.y_bar.row(3 * p), b.x_bar.width, b.x_bar.row(p));
  apply_gate(b.gate, b.x_bar);
}

template <class T>
void Coordinates<T>::tangent(const LayerArgs<T>&, const Tangent<T>& t) const {
  for (Index p = 0; p < grid_.positions(); ++p) {
    copy_row(t.x_dot.row(p), t.x.width, t.y_dot.row(3 * p));
    for (const Index place : {1, 2})
      std::fill_n(t.y_dot.row(3 * p + place), t.x.width, T(0));
  }
}

template <class T>
void Coordinates<T>::backward_tangent(const LayerArgs<T>& at,
                                      const BackwardTangent<T>& b) const {
  if (!b.x_bar) return;
  backward(at, b.base());
  backward(at, {.x = b.x, .y_bar = b.y_bar_dot, .x_bar = b.x_bar_dot});
}

template <class T>
void Flatten<T>::forward(const LayerArgs<T>&,
                         Lanes<const T> x,
                         Lanes<T> y) const {
  each_left([&](Index p, Index to) {
    for (Index c = 0; c < channels_; ++c)
      copy_row(x.row(p * channels_ + c), x.width, y.row(c * left() + to));
  });
}

template <class T>
void Flatten<T>::backward(const LayerArgs<T>&, const Backward<T>& b) const {
  if (!b.x_bar) return;
  if (hidden_ > 0)
    for (Index row = 0; row < this->inputs(); ++row)
      std::fill_n(b.x_bar.row(row), b.x_bar.width, T(0));
  each_left([&](Index p, Index from) {
    for (Index c = 0; c < channels_; ++c)
      copy_row(b.y_bar.row(c * left() + from),
               b.x_bar.width,
               b.x_bar.row(p * channels_ + c));
  });
  apply_gate(b.gate, b.x_bar);
}

template class FieldInput<float>;
template class FieldInput<double>;
template class Coordinates<float>;
template class Coordinates<double>;
template class Flatten<float>;
template class Flatten<double>;

}  // namespace physinv::nn
