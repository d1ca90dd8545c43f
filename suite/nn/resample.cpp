#include "suite/nn/resample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "suite/core/check.h"
#include "suite/nn/activation.h"

namespace physinv::nn {
namespace {

template <class T>
using V = NarrowPack<T>;

/// Input positions of a pooling cell, two or four of them.
struct Cell {
  std::array<Index, 4> position;
};

Cell cell(Grid grid, Index output) {
  const Index half = grid.columns / 2;  // an odd column is in no cell
  if (grid.flat()) return {{2 * output, 2 * output + 1, 0, 0}};
  const Index first = output / half * 2 * grid.columns + output % half * 2;
  return {{first, first + 1, first + grid.columns, first + grid.columns + 1}};
}

/// The two sources of an output along one axis, the nearer one first.
struct Pair {
  Index near, far;
  double weight;  ///< of the nearer one
};

/// Of output i of m from n inputs.
Pair sources(Index i, Index n, Index m) {
  const double at = (static_cast<double>(i) + 0.5) * static_cast<double>(n) /
                        static_cast<double>(m) -
                    0.5;
  const double below = std::floor(at), w = at - below;
  const auto j = static_cast<Index>(below);
  const Index low = std::clamp<Index>(j, 0, n - 1),
              high = std::clamp<Index>(j + 1, 0, n - 1);
  return w > 0.5 ? Pair{high, low, w} : Pair{low, high, 1 - w};
}

/// What an input gives to the outputs it is a source of, in their order.
struct Shares {
  Shares(Index i, Index n, Index m) {
    const Index last = std::min(m - 1, 2 * i + 4);
    for (Index o = std::max<Index>(0, 2 * i - 2); o <= last; ++o) {
      const Pair s = sources(o, n, m);
      const double share =
          (s.near == i ? s.weight : 0) + (s.far == i ? 1 - s.weight : 0);
      if (share == 0) continue;
      output[count] = o;
      weight[count++] = share;
    }
  }
  std::array<Index, 7> output{};
  std::array<double, 7> weight{};
  std::size_t count = 0;
};

template <class T, class F>
void each_position(const Replay<T>& at, Grid grid, Index numbers, F&& f) {
  for_rows(at, grid.positions(), numbers, [&](Index begin, Index end) {
    for (Index p = begin; p < end; ++p) f(p);
  });
}

/// f(output row, its 2 or 4 input rows) of every pooling cell.
template <class T, class F>
void each_output(
    const Replay<T>& at, Rows<const T> y, Grid grid, Index channels, F&& f) {
  const auto cells = [&]<int N>() {
    for_rows(at, y.rows, y.stride, [&](Index begin, Index end) {
      for (Index i = begin; i < end;) {
        const Cell from = cell(grid, i / channels);
        std::array<Index, N> rows;
        for (std::size_t k = 0; k < N; ++k)
          rows[k] = from.position[k] * channels + i % channels;
        const Index last = std::min(end, (i / channels + 1) * channels);
        for (; i < last; ++i) {
          f(i, rows);
          for (Index& row : rows) ++row;
        }
      }
    });
  };
  if (grid.flat()) {
    cells.template operator()<2>();
  } else {
    cells.template operator()<4>();
  }
}

void check_axis(Index n, Index m) {
  SUITE_CHECK(m == 2 * n || m == 2 * n + 1 || (n == 1 && m == 1),
              "upsampling must double an axis, or double it plus one");
}

template <class T>
class MaxPool final : public PiecewiseLinear<T> {
 public:
  /// `grid` is that of the input.
  MaxPool(Grid grid, Index channels)
      : PiecewiseLinear<T>(grid.positions() * channels,
                           halved(grid).positions() * channels),
        grid_(grid),
        channels_(channels) {}

  void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const override {
    each_output<T>(at, y, grid_, channels_, [&](Index i, const auto& rows) {
      for (Index j = 0; j < x.width; j += kNarrowLanes<T>) {
        V<T> top = load<V<T>>(x.row(rows[0]) + j);
        for (std::size_t k = 1; k < rows.size(); ++k) {
          const V<T> v = load<V<T>>(x.row(rows[k]) + j);
          top = ((top >= v) | (top != top)) ? top : v;  // keeps NaN
        }
        store(y.row(i) + j, top);
      }
    });
  }

  void backward(const Replay<T>& at, const Backward<T>& b) const override {
    if (!b.x_bar) return;
    if (grid_.columns % 2 != 0 || (!grid_.flat() && grid_.rows % 2 != 0))
      std::fill_n(b.x_bar.data, b.x_bar.rows * b.x_bar.stride, T(0));
    each_output<T>(at, b.y, grid_, channels_, [&](Index i, const auto& rows) {
      for (Index j = 0; j < b.x.width; j += kNarrowLanes<T>) {
        const V<T> top = load<V<T>>(b.y.row(i) + j);
        V<T> rest = load<V<T>>(b.y_bar.row(i) + j);
        for (const Index row : rows) {
          const auto here = load<V<T>>(b.x.row(row) + j) == top;
          store(b.x_bar.row(row) + j, here ? rest : V<T>{});
          rest = here ? V<T>{} : rest;
        }
      }
    });
    apply_gate(b.gate, b.x_bar);
  }

  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    each_output<T>(at, t.y, grid_, channels_, [&](Index i, const auto& rows) {
      for (Index j = 0; j < t.x.width; j += kNarrowLanes<T>) {
        const V<T> top = load<V<T>>(t.y.row(i) + j);
        V<T> dot{};
        for (std::size_t k = rows.size(); k-- > 0;) {
          const auto here = load<V<T>>(t.x.row(rows[k]) + j) == top;
          dot = here ? load<V<T>>(t.x_dot.row(rows[k]) + j) : dot;
        }
        store(t.y_dot.row(i) + j, dot);
      }
    });
  }

 private:
  Grid grid_;
  Index channels_;
};

template <class T>
class Upsample final : public PiecewiseLinear<T> {
 public:
  Upsample(Grid from, Grid to, Index channels)
      : PiecewiseLinear<T>(from.positions() * channels,
                           to.positions() * channels),
        grid_(from),
        fine_(to),
        channels_(channels) {
    check_axis(from.columns, to.columns);
    check_axis(from.rows, to.rows);
  }

  bool reads_output() const override { return false; }

  void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const override {
    const auto row = [&](Index r, Index c, Index channel, Index j) {
      return load<V<T>>(x.row((r * grid_.columns + c) * channels_ + channel) +
                        j);
    };
    each_position(at, fine_, channels_ * x.stride, [&](Index p) {
      const Pair h = sources(p % fine_.columns, grid_.columns, fine_.columns);
      const Pair v = sources(p / fine_.columns, grid_.rows, fine_.rows);
      const auto two = [](const Pair& pair, V<T> near, V<T> far) {
        return fma_lanes(broadcast<V<T>>(static_cast<T>(1 - pair.weight)),
                         far,
                         broadcast<V<T>>(static_cast<T>(pair.weight)) * near);
      };
      for (Index c = 0; c < channels_; ++c)
        for (Index j = 0; j < x.width; j += kNarrowLanes<T>) {
          const auto along = [&](Index r) {
            return two(h, row(r, h.near, c, j), row(r, h.far, c, j));
          };
          V<T> value = along(v.near);
          if (!grid_.flat()) value = two(v, value, along(v.far));
          store(y.row(p * channels_ + c) + j, value);
        }
    });
  }

  void backward(const Replay<T>& at, const Backward<T>& b) const override {
    if (!b.x_bar) return;
    // Every input gathers from its outputs, in order.
    each_position(at, grid_, channels_ * b.x_bar.stride, [&](Index p) {
      const Shares h(p % grid_.columns, grid_.columns, fine_.columns);
      const Shares v(p / grid_.columns, grid_.rows, fine_.rows);
      std::array<const T*, 49> from;
      std::array<T, 49> weight;
      std::size_t count = 0;
      for (std::size_t a = 0; a < v.count; ++a)
        for (std::size_t k = 0; k < h.count; ++k) {
          const Index output = v.output[a] * fine_.columns + h.output[k];
          from[count] = b.y_bar.row(output * channels_);
          weight[count++] = static_cast<T>(v.weight[a] * h.weight[k]);
        }
      T* const to = b.x_bar.row(p * channels_);
      for (Index c = 0; c < channels_; ++c)
        for (Index j = 0; j < b.x_bar.width; j += kNarrowLanes<T>) {
          const Index at_lane = c * b.x_bar.stride + j;
          V<T> sum{};
          for (std::size_t k = 0; k < count; ++k)
            sum = fma_lanes(
                broadcast<V<T>>(weight[k]), load<V<T>>(from[k] + at_lane), sum);
          store(to + at_lane, sum);
        }
    });
    apply_gate(b.gate, b.x_bar);
  }

 private:
  Grid grid_, fine_;
  Index channels_;
};

}  // namespace

template <class T>
LayerPointer<T> max_pool(Grid grid, Index channels) {
  return std::make_unique<MaxPool<T>>(grid, channels);
}

template <class T>
LayerPointer<T> upsample(Grid from, Grid to, Index channels) {
  return std::make_unique<Upsample<T>>(from, to, channels);
}

#define PHYSINV_INSTANTIATE(T)                \
  template decltype(max_pool<T>) max_pool<T>; \
  template decltype(upsample<T>) upsample<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
