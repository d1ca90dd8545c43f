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
  using P = typename Reg::P;
  static constexpr int kCount = N * Reg::kVectors;
  const T* x[kCount];
  T* y[kCount];

  template <class U>
  static P at(const U* of, int c, Index offset) {
    return Reg::of(of[c * Reg::kVectors] + offset,
                   of[(c + 1) * Reg::kVectors - 1] + offset);
  }
  void put(P v, int c, Index offset) const {
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
  using V = typename C::P;
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

/// Positions [first, first + count) of runs that are alike.
struct Piece {
  Index first, count;
};

/// Walks over the vectors of samples of all pieces' positions, lane by lane.
template <class T, class V>
struct Walk {
  Index x_step, y_step, lane0, vectors;  ///< per position
  const T* x;
  T* y;
  const Piece* piece;
  Index position = piece->first, last = piece->first + piece->count;
  Index vector = 0;

  template <int N, bool kPair>
  Columns<T, V, N, kPair> next() {
    constexpr Index w = sizeof(V) / sizeof(T);
    Columns<T, V, N, kPair> c;
    for (int i = 0; i < c.kCount; ++i) {
      if (position == last) {
        ++piece;
        position = piece->first, last = position + piece->count;
      }
      const Index lane = lane0 + vector * w;
      c.x[i] = x + position * x_step + lane;
      c.y[i] = y + position * y_step + lane;
      if (++vector == vectors) vector = 0, ++position;
    }
    return c;
  }
};

template <class T, class V>
void convolve_pieces(const Product<T>& g,
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

/// Calls f(run, pieces, their positions) for positions [begin, end) of the runs
/// from `run` on, those alike together: so the single positions at the edges
/// of a plane's rows fill a tile.
template <class F>
void for_alike(const WindowRun* run,
               const WindowRun* last,
               Index begin,
               Index end,
               F&& f) {
  constexpr Index kMost = 64;
  while (run != last && run->first < end) {
    // At most so many runs at once.
    const WindowRun* stop = run;
    while (stop != last && stop->first < end && stop - run < kMost) ++stop;
    std::uint64_t done = 0;
    for (Index i = 0; i < stop - run; ++i) {
      Piece pieces[kMost];
      Index found = 0, count = 0;
      for (Index j = i; j < stop - run; ++j) {
        const WindowRun& r = run[j];
        if ((done >> j & 1) != 0 || r.alike != run[i].alike) continue;
        done |= std::uint64_t{1} << j;
        const Index first = std::max(begin, r.first);
        pieces[found] = {first, std::min(end, r.first + r.count) - first};
        count += pieces[found++].count;
      }
      if (found > 0) f(run[i], pieces, count);
    }
    run = stop;
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
              const std::vector<WindowRun>& runs,
              const T* packed,
              const T* bias,
              Rows<const T> x,
              Rows<T> y,
              Index begin,
              Index end,
              Into into) {
  const Split<T> split(x.width);
  const Index out = shape.out;
  const Index x_step = shape.in * x.stride, y_step = out * x.stride;
  const auto product = [&](const WindowRun& like,
                           const Piece* pieces,
                           Index count) {
    const Product<T> g{shape.in,
                       shape.depth(),
                       x.stride,
                       like.segments.data(),
                       static_cast<Index>(like.segments.size()),
                       into};
    const auto by = [&]<class V>(Index lane0, Index vectors) {
      if (vectors > 0)
        convolve_pieces<T, V>(
            g,
            packed,
            bias,
            out,
            {x_step, y_step, lane0, vectors, x.data, y.data, pieces},
            vectors * count);
    };
    by.template operator()<Pack<T>>(0, split.wide);
    by.template operator()<NarrowPack<T>>(split.wide * kLanes<T>, split.narrow);
  };
  const WindowRun* const last = runs.data() + runs.size();
  const WindowRun* const some =
      std::partition_point(runs.data(), last, [&](const WindowRun& r) {
        return r.first + r.count <= begin;
      });
  for_alike(some, last, begin, end, product);
}

#define PHYSINV_INSTANTIATE(T)                        \
  template decltype(pack_weights<T>) pack_weights<T>; \
  template decltype(pack_flipped<T>) pack_flipped<T>; \
  template decltype(convolve<T>) convolve<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
