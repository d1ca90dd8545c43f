#include "suite/nn/conv_kernels.h"

#include <algorithm>

#include "suite/nn/conv_registers.h"

namespace physinv::nn {
namespace {

// Register tiles of outputs x columns: channel counts are multiples of 8 more
// often than of 6.
#ifdef PHYSINV_AVX512
constexpr int kPanel = 8, kColumns = 3;
#else
constexpr int kPanel = 4, kColumns = 3;
#endif

/// One column = one vector of samples at one position; N registers of them.
template <class T, class V, int N, bool kPair>
struct Columns {
  using Reg = Register<T, V, kPair>;
  using Whole = typename Reg::Whole;
  static constexpr int kCount = N * Reg::kVectors;
  const T* x[kCount];
  T* y[kCount];

  template <class P>
  static Whole at(const P* of, int c, Index offset) {
    return Reg::of(of[c * Reg::kVectors] + offset,
                   of[(c + 1) * Reg::kVectors - 1] + offset);
  }
  void put(Whole v, int c, Index offset) const {
    Reg::put(v,
             y[c * Reg::kVectors] + offset,
             y[(c + 1) * Reg::kVectors - 1] + offset);
  }
};

/// What all tiles of one run share.
template <class T>
struct Product {
  Index in, depth, stride;
  const Segment* segments;
  Index segment_count;
  Into into;
};

/// M outputs x N registers of columns.
template <class T, int M, int N, class C>
[[gnu::noinline]] void tile(const Product<T>& g,
                            const T* panel,
                            const T* bias,
                            Index output,
                            const C& columns) {
  using V = typename C::Whole;
  V acc[M][N];
#pragma GCC unroll 16
  for (int r = 0; r < M; ++r)
#pragma GCC unroll 8
    for (int c = 0; c < N; ++c)
      acc[r][c] = bias != nullptr ? broadcast<V>(bias[output + r]) : V{};
  if (g.into == Into::sum)
#pragma GCC unroll 16
    for (int r = 0; r < M; ++r)
#pragma GCC unroll 8
      for (int c = 0; c < N; ++c)
        acc[r][c] = columns.at(columns.y, c, (output + r) * g.stride);
  for (Index s = 0; s < g.segment_count; ++s) {
    const Segment segment = g.segments[s];
    const T* a = panel + segment.tap * g.in * M;
    const T* x[C::kCount];
#pragma GCC unroll 8
    for (int c = 0; c < C::kCount; ++c)
      x[c] = columns.x[c] + segment.shift * g.in * g.stride;
    for (Index k = segment.taps * g.in; k > 0; --k, a += M) {
      V b[N];
#pragma GCC unroll 8
      for (int c = 0; c < N; ++c) b[c] = held(columns.at(x, c, 0));
#pragma GCC unroll 8
      for (int c = 0; c < C::kCount; ++c) x[c] += g.stride;
#pragma GCC unroll 16
      for (int r = 0; r < M; ++r) {
        const V w = broadcast<V>(a[r]);
#pragma GCC unroll 8
        for (int c = 0; c < N; ++c) acc[r][c] = fma_lanes(w, b[c], acc[r][c]);
      }
    }
  }
#pragma GCC unroll 16
  for (int r = 0; r < M; ++r)
#pragma GCC unroll 8
    for (int c = 0; c < N; ++c)
      columns.put(acc[r][c], c, (output + r) * g.stride);
}

/// The last outputs, fewer than a panel.
template <class T, int M, int N, class C>
void last_panel(const Product<T>& g,
                const T* panel,
                const T* bias,
                Index output,
                Index outputs,
                const C& columns) {
  if constexpr (M > 0) {
    if (outputs == M) {
      tile<T, M, N>(g, panel, bias, output, columns);
    } else {
      last_panel<T, M - 1, N>(g, panel, bias, output, outputs, columns);
    }
  }
}

template <class T, class V, int N, bool kPair>
void all_outputs(const Product<T>& g,
                 const T* packed,
                 const T* bias,
                 Index out,
                 const Columns<T, V, N, kPair>& columns) {
  Index i = 0;
  for (; i + kPanel <= out; i += kPanel)
    tile<T, kPanel, N>(g, packed + i * g.depth, bias, i, columns);
  last_panel<T, kPanel - 1, N>(
      g, packed + i * g.depth, bias, i, out - i, columns);
}

/// Walks over the vectors of samples of a run's positions, lane by lane.
template <class T, class V>
struct Walk {
  Index x_step, y_step, lane0, vectors;  ///< per position
  const T* x;
  T* y;
  Index position = 0, vector = 0;

  template <int N, bool kPair>
  Columns<T, V, N, kPair> next() {
    constexpr Index w = sizeof(V) / sizeof(T);
    Columns<T, V, N, kPair> c;
    for (int i = 0; i < c.kCount; ++i) {
      const Index lane = lane0 + vector * w;
      c.x[i] = x + position * x_step + lane;
      c.y[i] = y + position * y_step + lane;
      if (++vector == vectors) vector = 0, ++position;
    }
    return c;
  }
};

template <class T, class V>
void convolve_run(const Product<T>& g,
                  const T* packed,
                  const T* bias,
                  Index out,
                  Walk<T, V> walk,
                  Index columns) {
  const auto by = [&]<int N, bool kPair>() {
    constexpr Index kSome = Columns<T, V, N, kPair>::kCount;
    for (; columns >= kSome; columns -= kSome)
      all_outputs(g, packed, bias, out, walk.template next<N, kPair>());
  };
  constexpr bool kPair = kPairs<T, V>;
  by.template operator()<kColumns, kPair>();
  if constexpr (kPair) by.template operator()<1, true>();
  by.template operator()<2, false>();
  by.template operator()<1, false>();
}

/// How a row's lanes are cut into vectors.
template <class T>
struct Split {
  explicit Split(Index width)
      : wide(width / kLanes<T>),
        narrow((width - wide * kLanes<T>) / kNarrowLanes<T>) {}
  Index wide, narrow;
};

/// Calls f(i, k, position in the packed array) for an `out` x `depth` matrix.
template <class F>
void for_packed(Index out, Index depth, F&& f) {
  for (Index i0 = 0; i0 < out; i0 += kPanel) {
    const Index rows = std::min<Index>(kPanel, out - i0);
    for (Index k = 0; k < depth; ++k)
      for (Index r = 0; r < rows; ++r) f(i0 + r, k, i0 * depth + k * rows + r);
  }
}

}  // namespace

template <class T>
void pack_weights(const ConvShape& shape, const T* weights, T* packed) {
  const Index taps = shape.taps.count(), in = shape.in;
  for_packed(shape.out, shape.depth(), [&](Index o, Index k, Index at) {
    packed[at] = weights[(o * in + k % in) * taps + k / in];
  });
}

template <class T>
void pack_flipped(const ConvShape& shape, const T* weights, T* packed) {
  const Index taps = shape.taps.count(), in = shape.in, out = shape.out;
  for_packed(in, taps * out, [&](Index c, Index k, Index at) {
    packed[at] = weights[(k % out * in + c) * taps + taps - 1 - k / out];
  });
}

template <class T>
void convolve(const ConvShape& shape,
              const std::vector<Run>& runs,
              const T* packed,
              const T* bias,
              Lanes<const T> x,
              Lanes<T> y,
              Index begin,
              Index end,
              Into into) {
  using Wide = Pack<T>;
  using Narrow = NarrowPack<T>;
  const Split<T> split(x.width);
  const Index wide = split.wide, narrow = split.narrow;
  const Index in = shape.in, out = shape.out;
  for (const Run& run : runs) {
    const Index first = std::max(begin, run.first);
    const Index count = std::min(end, run.first + run.count) - first;
    if (count <= 0) continue;
    const Product<T> g{in,
                       shape.depth(),
                       x.stride,
                       run.segments.data(),
                       static_cast<Index>(run.segments.size()),
                       into};
    const Index x_step = in * x.stride, y_step = out * x.stride;
    const T* from = x.data + first * x_step;
    T* to = y.data + first * y_step;
    if (wide > 0)
      convolve_run<T, Wide>(g,
                            packed,
                            bias,
                            out,
                            {x_step, y_step, 0, wide, from, to},
                            wide * count);
    if (narrow > 0)
      convolve_run<T, Narrow>(
          g,
          packed,
          bias,
          out,
          {x_step, y_step, wide * kLanes<T>, narrow, from, to},
          narrow * count);
  }
}

#define PHYSINV_INSTANTIATE(T)                                   \
  template void pack_weights<T>(const ConvShape&, const T*, T*); \
  template void pack_flipped<T>(const ConvShape&, const T*, T*); \
  template void convolve<T>(const ConvShape&,                    \
                            const std::vector<Run>&,             \
                            const T*,                            \
                            const T*,                            \
                            Lanes<const T>,                      \
                            Lanes<T>,                            \
                            Index,                               \
                            Index,                               \
                            Into);
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
