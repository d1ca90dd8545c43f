#include "suite/nn/conv_weights.h"

#include <algorithm>

#include "suite/nn/conv_registers.h"

namespace physinv::nn {
namespace {

// Register tiles of outputs x inputs: channel counts are multiples of 8 more
// often than of 6, and depths are multiples of 3.
#ifdef PHYSINV_AVX512
constexpr int kOutTile = 8, kInTile = 6;
#else
constexpr int kOutTile = 4, kInTile = 3;
#endif
constexpr Index kBlockBytes = 16384, kWeightBytes = 32768;

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

}  // namespace

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
