#include "suite/nn/channel_norm.h"

#include <algorithm>
#include <cmath>

#include "suite/core/check.h"
#include "suite/nn/activation.h"
#include "suite/nn/norm_constants.h"
#include "suite/nn/norm_lanes.h"

namespace physinv::nn {
namespace {

template <class T>
using V = NarrowPack<T>;

template <class T>
double total(V<T> v) {
  double sum = 0;
  for (Index l = 0; l < kNarrowLanes<T>; ++l) sum += double(v[l]);
  return sum;
}

/// Keeps NaN from either side.
template <class T>
V<T> larger(V<T> a, V<T> b) {
  return ((a >= b) | (a != a)) ? a : b;
}

template <class T, int N, bool kRelu>
void normalise_cells(NormPass<T> of, Rows<T> y, Index begin, Index end) {
  const auto& [s, at, parameters, x, none] = of;
  const Activation f = kRelu ? Activation::relu : s.activation;
  const NormCell<N> cell(s);
  for (Index c = 0; c < s.channels; ++c) {
    const NormChannel<T> u(at, parameters, s.channels, c);
    for (Index p = begin; p < end; ++p) {
      const T* from = x.row(cell.first(p) * s.channels + c);
      T* to = y.row(p * s.channels + c);
      for (Index j = 0; j < x.width; j += kNarrowLanes<T>) {
        V<T> top = u(load<V<T>>(from + j));
        for (std::size_t i = 1; i < N; ++i)
          top =
              larger<T>(top, u(load<V<T>>(from + cell.row[i] * x.stride + j)));
        store(to + j, activate_lanes<T>(f, top));
      }
    }
  }
}

// A ReLU's gate is known from u, which costs less than reading y again.

template <class T, int N, bool kRelu>
void sum_cells(
    NormPass<T> of, Rows<const T> y_bar, Index begin, Index end, T* sums) {
  const auto& [s, at, parameters, x, y] = of;
  const Activation f = kRelu ? Activation::relu : s.activation;
  const NormCell<N> cell(s);
  const SampleMask<T> mask(x.samples);
  for (Index c = 0; c < s.channels; ++c) {
    const NormChannel<T> u(at, parameters, s.channels, c);
    V<T> sum{}, product{};
    for (Index p = begin; p < end; ++p) {
      const T* from = x.row(cell.first(p) * s.channels + c);
      const Index row = p * s.channels + c;
      for (Index j = 0; j < x.width; j += kNarrowLanes<T>) {
        V<T> best = load<V<T>>(from + j), top = u(best);
        for (std::size_t i = 1; i < N; ++i) {
          const V<T> v = load<V<T>>(from + cell.row[i] * x.stride + j);
          const V<T> w = u(v);
          const auto keep = top >= w;
          best = keep ? best : v, top = keep ? top : w;
        }
        const V<T> g =
            mask(j,
                 pull_lanes<T>(f,
                               kRelu ? top : load<V<T>>(y.row(row) + j),
                               load<V<T>>(y_bar.row(row) + j)));
        sum += g;
        product += mask(j, g * ((best - u.mean) * u.inverse));
      }
    }
    sums[c] = static_cast<T>(total<T>(sum));
    sums[s.channels + c] = static_cast<T>(total<T>(product));
  }
}

template <class T, int N, bool kRelu>
void pull_cells(NormPass<T> of,
                const T* means,
                Rows<const T> y_bar,
                Rows<T> x_bar,
                Index begin,
                Index end) {
  const auto& [s, at, parameters, x, y] = of;
  const Activation f = kRelu ? Activation::relu : s.activation;
  const NormCell<N> cell(s);
  const SampleMask<T> mask(x.samples);
  for (Index c = 0; c < s.channels; ++c) {
    const NormChannel<T> u(at, parameters, s.channels, c);
    const V<T> mean = broadcast<V<T>>(means[c]);
    const V<T> slope = broadcast<V<T>>(means[s.channels + c]);
    for (Index p = begin; p < end; ++p) {
      const Index at_cell = cell.first(p) * s.channels + c;
      const T* from = x.row(at_cell);
      T* to = x_bar.row(at_cell);
      const Index row = p * s.channels + c;
      for (Index j = 0; j < x.width; j += kNarrowLanes<T>) {
        V<T> v[N];
        V<T> top{};
        for (std::size_t i = 0; i < N; ++i) {
          v[i] = load<V<T>>(from + cell.row[i] * x.stride + j);
          top = i == 0 ? u(v[0]) : larger<T>(top, u(v[i]));
        }
        const V<T> g = pull_lanes<T>(f,
                                     kRelu ? top : load<V<T>>(y.row(row) + j),
                                     load<V<T>>(y_bar.row(row) + j));
        // A tie's cotangent goes to the first.
        auto open = top == top;
        for (std::size_t i = 0; i < N; ++i) {
          V<T> own = g;
          if constexpr (N > 1) {
            const auto here = open & (u(v[i]) == top);
            open = open & ~here;
            own = here ? g : V<T>{};
          }
          const V<T> normal = (v[i] - u.mean) * u.inverse;
          store(to + cell.row[i] * x.stride + j,
                mask(j, u.factor * (own - mean - normal * slope)));
        }
      }
    }
  }
}

/// Moments of G neighbouring channels at once: their sums hide each other's
/// latency.
template <class T, int G>
void moments_of(Rows<const T> x,
                Index channels,
                Index channel,
                Index begin,
                Index end,
                T* moments) {
  const SampleMask<T> mask(x.samples);
  const auto count = static_cast<double>((end - begin) * x.samples);
  V<T> mean[G] = {}, sum[G] = {};
  const auto pass = [&](auto&& add) {
    for (Index p = begin; p < end; ++p) {
      const T* row = x.row(p * channels + channel);
      for (Index j = 0; j < mask.full; j += kNarrowLanes<T>)
#pragma GCC unroll 4
        for (int g = 0; g < G; ++g)
          add(g, load<V<T>>(row + g * x.stride + j) - mean[g]);
      if (mask.full < x.samples)
#pragma GCC unroll 4
        for (int g = 0; g < G; ++g)
          add(g,
              mask(mask.full,
                   load<V<T>>(row + g * x.stride + mask.full) - mean[g]));
    }
  };
  pass([&](int g, V<T> v) { sum[g] += v; });
  for (int g = 0; g < G; ++g) {
    moments[g] = static_cast<T>(total<T>(sum[g]) / count);
    mean[g] = broadcast<V<T>>(moments[g]), sum[g] = V<T>{};
  }
  pass([&](int g, V<T> v) { sum[g] = fma_lanes(v, v, sum[g]); });
  for (int g = 0; g < G; ++g)
    moments[channels + g] = static_cast<T>(total<T>(sum[g]));
}

}  // namespace

Grid halved(Grid grid) {
  SUITE_CHECK(grid.columns >= 2 && (grid.flat() || grid.rows >= 2),
              "pooling by 2 needs two positions per axis");
  return {grid.columns / 2, grid.flat() ? 1 : grid.rows / 2};
}

Grid NormShape::pooled() const {
  if (!pool) return grid;
  SUITE_CHECK(grid.columns % 2 == 0 && (grid.flat() || grid.rows % 2 == 0),
              "pooling inside a block needs an even extent");
  return halved(grid);
}

template <class T>
void block_moments(
    Rows<const T> x, Index channels, Index begin, Index end, T* moments) {
  Index c = 0;
  for (; c + 4 <= channels; c += 4)
    moments_of<T, 4>(x, channels, c, begin, end, moments + c);
  for (; c < channels; ++c)
    moments_of<T, 1>(x, channels, c, begin, end, moments + c);
}

template <class T>
void combine_moments(const T* moments,
                     Index channels,
                     Index positions,
                     Index per_block,
                     Index samples,
                     NormColumns<T> to) {
  const auto count = static_cast<double>(positions * samples);
  SUITE_CHECK(positions * samples >= 2, "batch statistics need two samples");
  for (Index c = 0; c < channels; ++c) {
    // Deviations are taken around each block's rounded mean, so that mean is
    // what the sums are moved from; its own rounding cancels to first order.
    double mean = 0, squares = 0;
    const T* m = moments + c;
    for (Index p = 0; p < positions; p += per_block, m += 2 * channels)
      mean += double(m[0]) *
              static_cast<double>(std::min(per_block, positions - p) * samples);
    mean /= count;
    m = moments + c;
    for (Index p = 0; p < positions; p += per_block, m += 2 * channels) {
      const auto some =
          static_cast<double>(std::min(per_block, positions - p) * samples);
      const double off = double(m[0]) - mean;
      squares += double(m[channels]) + some * off * off;
    }
    to.mean[c] = static_cast<T>(mean);
    to.inverse[c] = static_cast<T>(1.0 / std::sqrt(squares / count + kNormEps));
    to.unbiased[c] = static_cast<T>(squares / (count - 1));
  }
}

template <class T>
void use_state(const T* state, Index channels, NormColumns<T> to) {
  for (Index c = 0; c < channels; ++c) {
    to.mean[c] = state[c];
    to.inverse[c] =
        static_cast<T>(1.0 / std::sqrt(double(state[channels + c]) + kNormEps));
    to.unbiased[c] = T(0);
  }
}

template <class T>
void move_state(NormColumns<T> batch, Index channels, T* state) {
  const T f = static_cast<T>(kNormMomentum),
          keep = static_cast<T>(1 - kNormMomentum);
  for (Index c = 0; c < channels; ++c) {
    state[c] = keep * state[c] + f * batch.mean[c];
    state[channels + c] = keep * state[channels + c] + f * batch.unbiased[c];
  }
}

template <class T>
void normalise(NormPass<T> of, Rows<T> y, Index begin, Index end) {
  dispatch_norm(of.shape, [&]<int N, bool kRelu>() {
    normalise_cells<T, N, kRelu>(of, y, begin, end);
  });
}

template <class T>
void block_sums(
    NormPass<T> of, Rows<const T> y_bar, Index begin, Index end, T* sums) {
  dispatch_norm(of.shape, [&]<int N, bool kRelu>() {
    sum_cells<T, N, kRelu>(of, y_bar, begin, end, sums);
  });
}

template <class T>
void combine_sums(const T* sums, Index blocks, Index channels, T* totals) {
  for (Index c = 0; c < 2 * channels; ++c) {
    double sum = 0;
    for (Index b = 0; b < blocks; ++b)
      sum += double(sums[b * 2 * channels + c]);
    totals[c] = static_cast<T>(sum);
  }
}

template <class T>
void pull_norm(NormPass<T> of,
               const T* means,
               Rows<const T> y_bar,
               Rows<T> x_bar,
               Index begin,
               Index end) {
  dispatch_norm(of.shape, [&]<int N, bool kRelu>() {
    pull_cells<T, N, kRelu>(of, means, y_bar, x_bar, begin, end);
  });
}

#define PHYSINV_INSTANTIATE(T)                              \
  template decltype(block_moments<T>) block_moments<T>;     \
  template decltype(combine_moments<T>) combine_moments<T>; \
  template decltype(use_state<T>) use_state<T>;             \
  template decltype(move_state<T>) move_state<T>;           \
  template decltype(normalise<T>) normalise<T>;             \
  template decltype(block_sums<T>) block_sums<T>;           \
  template decltype(combine_sums<T>) combine_sums<T>;       \
  template decltype(pull_norm<T>) pull_norm<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
