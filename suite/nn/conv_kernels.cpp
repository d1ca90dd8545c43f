#include "suite/nn/conv_kernels.h"

#include <immintrin.h>

#include <algorithm>
#include <cstring>

#include "suite/core/simd/pack.h"

namespace physinv::nn {
namespace {

// Register tiles. Channel counts are multiples of 8 more often than of 6, and
// depths are multiples of 3.
#ifdef PHYSINV_AVX512
constexpr int kPanel = 8, kColumns = 3;   ///< outputs x columns
constexpr int kOutTile = 8, kInTile = 6;  ///< weight gradient
#else
constexpr int kPanel = 4, kColumns = 3;
constexpr int kOutTile = 4, kInTile = 3;
#endif
constexpr Index kBlockBytes = 16384, kWeightBytes = 32768;

/// Two narrow vectors share a wide register: what is computed of each stays as
/// it is, in half the instructions.
template <class T, class V, bool kPair>
struct Register {
  static constexpr int kVectors = kPair ? 2 : 1;
  using Whole = Pack<T, kVectors* static_cast<int>(sizeof(V) / sizeof(T))>;

  /// a, and b if there is room for it.
  static Whole of(const T* a, const T* b) {
    if constexpr (kPair) {
      return side_by_side(load<V>(a), load<V>(b));
    } else {
      return load<V>(a);
    }
  }
  /// a in both halves, by one load and no shuffle.
  static Whole twice(const T* a) {
#ifdef PHYSINV_AVX512
    if constexpr (kPair && sizeof(T) == 4) {
      return reinterpret_cast<Whole>(
          _mm512_maskz_broadcast_f32x8(0xFFFF, _mm256_loadu_ps(a)));
    } else if constexpr (kPair) {
      return reinterpret_cast<Whole>(
          _mm512_maskz_broadcast_f64x4(0xFF, _mm256_loadu_pd(a)));
    }
#endif
    return of(a, a);
  }
  static void put(Whole v, T* a, T* b) {
    if constexpr (kPair) {
      V halves[2];
      std::memcpy(halves, &v, sizeof(v));
      store(a, halves[0]), store(b, halves[1]);
    } else {
      store(a, v);
    }
  }
};
template <class T, class V>
constexpr bool kPairs = 2 * sizeof(V) <= kVectorBytes;

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

/// R outputs x Q inputs, each a vector of partial sums. kOne: a row is one
/// vector, so that distances between rows are known to the compiler.
template <class T, class V, int R, int Q, bool kOne>
[[gnu::noinline]] void weight_tile(const T* x,
                                   Index x_step,
                                   const T* y,
                                   Index y_step,
                                   Index stride,
                                   Index positions,
                                   Index vectors,
                                   T* sums,
                                   Index sums_step) {
  using Reg = Register<T, V, kPairs<T, V> && Q % 2 == 0>;
  using W = typename Reg::Whole;
  constexpr Index w = sizeof(V) / sizeof(T), wide = sizeof(W) / sizeof(T);
  constexpr int kInputs = Q / Reg::kVectors;
  const Index row = kOne ? w : stride;
  W acc[R][kInputs];
#pragma GCC unroll 8
  for (int r = 0; r < R; ++r)
#pragma GCC unroll 8
    for (int q = 0; q < kInputs; ++q)
      acc[r][q] = load<W>(sums + r * sums_step + q * wide);
  const auto add = [&](const T* from, const T* by) {
    W xv[kInputs];
#pragma GCC unroll 8
    for (int q = 0; q < kInputs; ++q) {
      const T* const first = from + q * Reg::kVectors * row;
      xv[q] = held(kOne ? load<W>(first) : Reg::of(first, first + row));
    }
#pragma GCC unroll 8
    for (int r = 0; r < R; ++r) {
      const W yv = held(Reg::twice(by + r * row));
#pragma GCC unroll 8
      for (int q = 0; q < kInputs; ++q)
        acc[r][q] = fma_lanes(yv, xv[q], acc[r][q]);
    }
  };
  // At least one of each, which keeps the sums in their registers.
  do {
    Index v = 0;
    do add(x + v, y + v);
    while (!kOne && (v += w) < vectors * w);
    x += x_step, y += y_step;
  } while (--positions > 0);
#pragma GCC unroll 8
  for (int r = 0; r < R; ++r)
#pragma GCC unroll 8
    for (int q = 0; q < kInputs; ++q)
      store(sums + r * sums_step + q * wide, acc[r][q]);
}

template <class T, class V, int Q>
void weight_rows(const T* x,
                 Index x_step,
                 const T* y,
                 Index y_step,
                 Index stride,
                 Index positions,
                 Index vectors,
                 Index out,
                 T* sums,
                 Index sums_step) {
  Index o = 0;
  const auto step = [&]<int R>() {
    const auto tile = stride == sizeof(V) / sizeof(T)
                          ? weight_tile<T, V, R, Q, true>
                          : weight_tile<T, V, R, Q, false>;
    tile(x,
         x_step,
         y + o * stride,
         y_step,
         stride,
         positions,
         vectors,
         sums + o * sums_step,
         sums_step);
    o += R;
  };
  while (o + kOutTile <= out) step.template operator()<kOutTile>();
  if constexpr (kOutTile > 4)
    while (o + 4 <= out) step.template operator()<4>();
  while (o < out) step.template operator()<1>();
}

/// One run of positions, lanes [lane, lane + vectors).
template <class T, class V>
void weight_run(const ConvShape& shape,
                const Run& run,
                Lanes<const T> x,
                Lanes<const T> y_bar,
                Index first,
                Index last,
                Index lane0,
                Index vectors,
                T* sums) {
  constexpr Index w = sizeof(V) / sizeof(T);
  if (vectors == 0) return;
  const Index stride = x.stride, in = shape.in;
  const Index x_step = in * stride, y_step = shape.out * stride;
  const Index sums_step = shape.depth() * w;
  // y_bar's part stays in the L1 while all inputs pass by; with many outputs
  // in the L2, as a tile's sums must not come and go too often.
  const Index budget = std::max<Index>(
      16, kWeightBytes / (shape.out * static_cast<Index>(sizeof(V))));
  const Index per_row = std::min(vectors, budget);
  const Index per_block = std::max<Index>(1, budget / per_row);
  for (Index p = first; p < last; p += per_block) {
    const Index count = std::min(per_block, last - p);
    for (Index v = 0; v < vectors; v += per_row) {
      const Index some = std::min(per_row, vectors - v);
      const Index lane = lane0 + v * w;
      const T* y = y_bar.data + p * y_step + lane;
      for (const Segment& s : run.segments) {
        const T* from = x.data + (p + s.shift) * x_step + lane;
        T* to = sums + s.tap * in * w;
        Index k = 0;
        const auto step = [&]<int Q>() {
          weight_rows<T, V, Q>(from + k * stride,
                               x_step,
                               y,
                               y_step,
                               stride,
                               count,
                               some,
                               shape.out,
                               to + k * w,
                               sums_step);
          k += Q;
        };
        const Index depth = s.taps * in;
        while (k + kInTile <= depth) step.template operator()<kInTile>();
        if constexpr (kInTile > 3)
          while (k + 3 <= depth) step.template operator()<3>();
        while (k < depth) step.template operator()<1>();
      }
    }
  }
}

/// How a row's lanes are cut into vectors.
template <class T>
struct Split {
  explicit Split(Index width)
      : wide(width / kLanes<T>),
        narrow((width - wide * kLanes<T>) / kNarrowLanes<T>) {}
  Index wide, narrow;
};

/// totals[i] += the lanes of vector i, one after the other.
template <class T>
void add_lanes(const T* sums, Index lanes, Index count, T* totals) {
  constexpr Index kSome = 64;
  T turned[16 * kSome];
  for (Index i = 0; i < count; i += kSome) {
    const Index some = std::min(kSome, count - i);
    transpose(sums + i * lanes, lanes, some, lanes, turned, kSome);
    for (Index l = 0; l < lanes; ++l)
      for (Index j = 0; j < some; ++j) totals[i + j] += turned[l * kSome + j];
  }
}

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

// Every lane sums over its own samples, so the number of lanes decides about
// the order: that of the narrow registers on every machine.
template <class T>
Index weight_sums(const ConvShape& shape) {
  return shape.weights() * kNarrowLanes<T>;
}

template <class T>
void accumulate_weights(const ConvShape& shape,
                        const std::vector<Run>& runs,
                        Lanes<const T> x,
                        Lanes<const T> y_bar,
                        Index begin,
                        Index end,
                        T* sums) {
  for (const Run& run : runs) {
    const Index first = std::max(begin, run.first);
    const Index last = std::min(end, run.first + run.count);
    if (first >= last) continue;
    weight_run<T, NarrowPack<T>>(
        shape, run, x, y_bar, first, last, 0, x.width / kNarrowLanes<T>, sums);
  }
}

template <class T>
void finish_weights(const ConvShape& shape,
                    const T* sums,
                    Index parts,
                    T* totals,
                    T* weights_bar) {
  const Index taps = shape.taps.count(), in = shape.in, depth = shape.depth();
  std::fill_n(totals, shape.weights(), T(0));
  for (Index part = 0; part < parts; ++part, sums += weight_sums<T>(shape))
    add_lanes(sums, kNarrowLanes<T>, shape.weights(), totals);
  for (Index o = 0; o < shape.out; ++o)
    for (Index t = 0; t < taps; ++t)
      for (Index c = 0; c < in; ++c)
        weights_bar[(o * in + c) * taps + t] = totals[o * depth + t * in + c];
}

template <class T>
Index positions_per_block(Lanes<const T> x, Index channels) {
  const Index bytes = channels * x.stride * static_cast<Index>(sizeof(T));
  return std::max<Index>(1, kBlockBytes / bytes);
}

#define PHYSINV_INSTANTIATE(T)                                                \
  template void pack_weights<T>(const ConvShape&, const T*, T*);              \
  template void pack_flipped<T>(const ConvShape&, const T*, T*);              \
  template void convolve<T>(const ConvShape&,                                 \
                            const std::vector<Run>&,                          \
                            const T*,                                         \
                            const T*,                                         \
                            Lanes<const T>,                                   \
                            Lanes<T>,                                         \
                            Index,                                            \
                            Index,                                            \
                            Into);                                            \
  template Index weight_sums<T>(const ConvShape&);                            \
  template void accumulate_weights<T>(const ConvShape&,                       \
                                      const std::vector<Run>&,                \
                                      Lanes<const T>,                         \
                                      Lanes<const T>,                         \
                                      Index,                                  \
                                      Index,                                  \
                                      T*);                                    \
  template void finish_weights<T>(const ConvShape&, const T*, Index, T*, T*); \
  template Index positions_per_block<T>(Lanes<const T>, Index);
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
