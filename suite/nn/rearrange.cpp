#include "suite/nn/rearrange.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "suite/nn/activation.h"

namespace physinv::nn {
namespace {

template <class T>
using V = NarrowPack<T>;

template <class T>
void copy_row(const T* from, Index width, T* to) {
  std::copy(from, from + width, to);
}

template <class T>
class FieldInput final : public PiecewiseLinear<T> {
 public:
  explicit FieldInput(const FieldInputOptions& o)
      : PiecewiseLinear<T>(o.inputs(), o.positions * o.width()), o_(o) {}

  void forward(const Run<T>&, Rows<const T> x, Rows<T> y) const override {
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

  void backward(const Replay<T>&, const Backward<T>& b) const override {
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
  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    FieldInputOptions linear = o_;
    linear.shift = 0;
    FieldInput(linear).forward({at, *t.dots, nullptr}, t.x_dot, t.y_dot);
  }

 private:
  FieldInputOptions o_;
};

template <class T>
class Coordinates final : public Layer<T> {
 public:
  explicit Coordinates(Grid grid)
      : Layer<T>(grid.positions(), 3 * grid.positions()), grid_(grid) {}

  void forward(const Run<T>&, Rows<const T> x, Rows<T> y) const override {
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
  void backward(const Replay<T>&, const Backward<T>& b) const override {
    if (!b.x_bar) return;
    for (Index p = 0; p < grid_.positions(); ++p)
      copy_row(b.y_bar.row(3 * p), b.x_bar.width, b.x_bar.row(p));
    apply_gate(b.gate, b.x_bar);
  }
  void tangent(const Replay<T>&, const Tangent<T>& t) const override {
    for (Index p = 0; p < grid_.positions(); ++p) {
      copy_row(t.x_dot.row(p), t.x.width, t.y_dot.row(3 * p));
      for (const Index place : {1, 2})
        std::fill_n(t.y_dot.row(3 * p + place), t.x.width, T(0));
    }
  }
  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    if (!b.x_bar) return;
    backward(at, b.base());
    backward(at, b.base_dot());
  }

 private:
  Grid grid_;
};

template <class T>
class Flatten final : public PiecewiseLinear<T> {
 public:
  Flatten(Index positions, Index channels, Index columns = 1, Index hidden = 0)
      : PiecewiseLinear<T>(positions * channels,
                           positions / columns * (columns - hidden) * channels),
        positions_(positions),
        channels_(channels),
        columns_(columns),
        hidden_(hidden) {}

  void forward(const Run<T>&, Rows<const T> x, Rows<T> y) const override {
    each_left([&](Index p, Index to) {
      for (Index c = 0; c < channels_; ++c)
        copy_row(x.row(p * channels_ + c), x.width, y.row(c * left() + to));
    });
  }

  void backward(const Replay<T>&, const Backward<T>& b) const override {
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

 private:
  /// f(position, place among those that are left).
  template <class F>
  void each_left(F&& f) const {
    Index left = 0;
    for (Index p = 0; p < positions_; ++p)
      if (p % columns_ >= hidden_) f(p, left++);
  }
  Index left() const { return this->outputs() / channels_; }

  Index positions_, channels_, columns_, hidden_;
};

}  // namespace

template <class T>
LayerPointer<T> field_input(const FieldInputOptions& options) {
  return std::make_unique<FieldInput<T>>(options);
}

template <class T>
LayerPointer<T> coordinates(Grid grid) {
  return std::make_unique<Coordinates<T>>(grid);
}

template <class T>
LayerPointer<T> flatten(Index positions,
                        Index channels,
                        Index columns,
                        Index hidden) {
  return std::make_unique<Flatten<T>>(positions, channels, columns, hidden);
}

#define PHYSINV_INSTANTIATE(T)                      \
  template decltype(field_input<T>) field_input<T>; \
  template decltype(coordinates<T>) coordinates<T>; \
  template decltype(flatten<T>) flatten<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
