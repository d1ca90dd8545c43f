#include "suite/nn/channel_norm_tangent.h"

#include "suite/nn/activation.h"
#include "suite/nn/norm_lanes.h"

namespace physinv::nn {
namespace {

template <class T>
using V = NarrowPack<T>;

/// One channel's constants and their derivatives in registers.
template <class T>
struct ChannelTangent : NormChannel<T> {
  ChannelTangent(const NormTangent<T>& of, Index c)
      : NormChannel<T>(of.at, of.parameters, of.shape.channels, c),
        mean_dot(broadcast<V<T>>(of.dots.mean[c])),
        slope(broadcast<V<T>>(of.dots.slope[c])),
        scale_dot(broadcast<V<T>>(of.parameters_dot[c])),
        offset_dot(broadcast<V<T>>(of.parameters_dot[of.shape.channels + c])) {}
  V<T> normal(V<T> x) const { return (x - this->mean) * this->inverse; }
  /// n' / inverse
  V<T> moved(V<T> n, V<T> x_dot) const {
    return fma_lanes(-n, slope, x_dot - mean_dot);
  }
  V<T> u_dot(V<T> x, V<T> x_dot) const {
    const V<T> n = normal(x);
    return fma_lanes(
        this->factor, moved(n, x_dot), fma_lanes(scale_dot, n, offset_dot));
  }
  V<T> mean_dot, slope, scale_dot, offset_dot;
};

template <class T, int N, bool kRelu>
void normalise_cells(const NormTangent<T>& of,
                     Rows<T> y_dot,
                     Index begin,
                     Index end) {
  const Activation f = kRelu ? Activation::relu : of.shape.activation;
  const NormCell<N> cell(of.shape);
  const Index channels = of.shape.channels;
  for (Index c = 0; c < channels; ++c) {
    const ChannelTangent<T> u(of, c);
    for (Index p = begin; p < end; ++p) {
      const Index first = cell.first(p) * channels + c;
      const Index row = p * channels + c;
      for (Index j = 0; j < of.x.width; j += kNarrowLanes<T>) {
        V<T> best = load<V<T>>(of.x.row(first) + j), top = u(best);
        V<T> dot = load<V<T>>(of.x_dot.row(first) + j);
        for (std::size_t i = 1; i < N; ++i) {
          const V<T> x = load<V<T>>(of.x.row(first + cell.row[i]) + j);
          const V<T> w = u(x);
          const auto keep = (top >= w) | (top != top);
          best = keep ? best : x, top = keep ? top : w;
          dot = keep ? dot : load<V<T>>(of.x_dot.row(first + cell.row[i]) + j);
        }
        store(y_dot.row(row) + j,
              pull_lanes<T>(f,
                            kRelu ? top : load<V<T>>(of.y.row(row) + j),
                            u.u_dot(best, dot)));
      }
    }
  }
}

template <class T, int N, bool kRelu>
void open(const NormTangent<T>& of,
          Rows<const T> y_dot,
          Rows<const T> y_bar,
          Rows<const T> y_bar_dot,
          Rows<T> u_bar,
          Rows<T> u_bar_dot,
          Index begin,
          Index end) {
  const Activation f = kRelu ? Activation::relu : of.shape.activation;
  const NormCell<N> cell(of.shape);
  const SampleMask<T> mask(of.x.samples);
  const Index channels = of.shape.channels;
  for (Index c = 0; c < channels; ++c) {
    const NormChannel<T> u(of.at, of.parameters, channels, c);
    for (Index p = begin; p < end; ++p) {
      const Index first = cell.first(p) * channels + c;
      const Index row = p * channels + c;
      for (Index j = 0; j < of.x.width; j += kNarrowLanes<T>) {
        V<T> w[N], top{};
        for (std::size_t i = 0; i < N; ++i) {
          w[i] = u(load<V<T>>(of.x.row(first + cell.row[i]) + j));
          top = i == 0 ? w[0] : (((top >= w[i]) | (top != top)) ? top : w[i]);
        }
        const V<T> y = kRelu ? top : load<V<T>>(of.y.row(row) + j);
        const V<T> bar = load<V<T>>(y_bar.row(row) + j);
        const V<T> g = mask(j, pull_lanes<T>(f, y, bar));
        const V<T> g_dot =
            mask(j,
                 pull_lanes<T>(f, y, load<V<T>>(y_bar_dot.row(row) + j)) +
                     bend_lanes<T>(f, y, bar * load<V<T>>(y_dot.row(row) + j)));
        auto open = top == top;
        for (std::size_t i = 0; i < N; ++i) {
          const auto here = open & (w[i] == top);
          open = open & ~here;
          const Index to = first + cell.row[i];
          store(u_bar.row(to) + j, N == 1 || here ? g : V<T>{});
          store(u_bar_dot.row(to) + j, N == 1 || here ? g_dot : V<T>{});
        }
      }
    }
  }
}

}  // namespace

template <class T>
void normalise_tangent(const NormTangent<T>& of,
                       Rows<T> y_dot,
                       Index begin,
                       Index end) {
  dispatch_norm(of.shape, [&]<int N, bool kRelu>() {
    normalise_cells<T, N, kRelu>(of, y_dot, begin, end);
  });
}

template <class T>
void open_cells(const NormTangent<T>& of,
                Rows<const T> y_dot,
                Rows<const T> y_bar,
                Rows<const T> y_bar_dot,
                Rows<T> u_bar,
                Rows<T> u_bar_dot,
                Index begin,
                Index end) {
  dispatch_norm(of.shape, [&]<int N, bool kRelu>() {
    open<T, N, kRelu>(
        of, y_dot, y_bar, y_bar_dot, u_bar, u_bar_dot, begin, end);
  });
}

template <class T>
void pull_norm_tangent(const NormTangent<T>& of,
                       const NormMeans<T>& means,
                       Rows<T> bar,
                       Rows<T> bar_dot,
                       Index begin,
                       Index end) {
  const SampleMask<T> mask(of.x.samples);
  const Index channels = of.shape.channels;
  for (Index c = 0; c < channels; ++c) {
    const ChannelTangent<T> u(of, c);
    const V<T> sum = broadcast<V<T>>(means.sum[c]);
    const V<T> product = broadcast<V<T>>(means.product[c]);
    const V<T> sum_dot = broadcast<V<T>>(means.sum_dot[c]);
    const V<T> product_dot = broadcast<V<T>>(means.product_dot[c]);
    // (scale inverse)'
    const V<T> factor_dot =
        u.inverse * fma_lanes(-u.factor, u.slope, u.scale_dot);
    for (Index p = begin; p < end; ++p) {
      const Index row = p * channels + c;
      for (Index j = 0; j < of.x.width; j += kNarrowLanes<T>) {
        const V<T> n = u.normal(load<V<T>>(of.x.row(row) + j));
        const V<T> n_dot =
            u.inverse * u.moved(n, load<V<T>>(of.x_dot.row(row) + j));
        const V<T> own =
            fma_lanes(-n, product, load<V<T>>(bar.row(row) + j) - sum);
        V<T> own_dot = load<V<T>>(bar_dot.row(row) + j) - sum_dot;
        own_dot = fma_lanes(-n_dot, product, own_dot);
        own_dot = fma_lanes(-n, product_dot, own_dot);
        store(bar.row(row) + j, mask(j, u.factor * own));
        store(bar_dot.row(row) + j,
              mask(j, fma_lanes(factor_dot, own, u.factor * own_dot)));
      }
    }
  }
}

#define PHYSINV_INSTANTIATE(T)                                  \
  template decltype(normalise_tangent<T>) normalise_tangent<T>; \
  template decltype(open_cells<T>) open_cells<T>;               \
  template decltype(pull_norm_tangent<T>) pull_norm_tangent<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
