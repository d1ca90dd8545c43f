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
// Below so many vectors a position, tiles hold their sums across edges.
constexpr Index kFewVectors = 4, kMostSpans = 64;

/// Output positions [first, first + count) that meet the inputs from
/// first + shift on.
struct Span {
  Index first, count, shift;
};

/// Of a run, positions [begin, end).
Span part_of(const WindowRun& run, Index begin, Index end) {
  const Index first = std::max(begin, run.first);
  return {first, std::min(end, run.first + run.count) - first, 0};
}

/// What the tiles of some taps share: sums += y[p][o] x[p + shift][k] over all
/// spans. Steps are distances in memory, of positions, rows, and outputs.
template <class T>
struct Sweep {
  const Span* spans;
  Index span_count;
  const T* x;
  const T* y;
  Index x_step, y_step, stride, vectors, out;
  T* sums;
  Index sums_step;
};

/// R outputs x Q inputs, each a vector of partial sums. kOne: a row is one
/// vector, so that distances between rows are known to the compiler.
template <class T, class V, int R, int Q, bool kOne>
[[gnu::noinline]] void weight_tile(const Sweep<T>& g, Index o, Index k) {
  using Reg = Register<T, V, kPairs<T, V> && Q % 2 == 0>;
  using W = typename Reg::P;
  constexpr Index w = sizeof(V) / sizeof(T), wide = sizeof(W) / sizeof(T);
  constexpr int kInputs = Q / Reg::kVectors;
  const Index row = kOne ? w : g.stride, vectors = g.vectors;
  const Index x_step = g.x_step, y_step = g.y_step, sums_step = g.sums_step;
  T* const sums = g.sums + o * sums_step + k * w;
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
  const Span* span = g.spans;
  const Span* const end = span + g.span_count;
  do {
    const T* x = g.x + (span->first + span->shift) * x_step + k * row;
    const T* y = g.y + span->first * y_step + o * row;
    Index positions = span->count;
    do {
      Index v = 0;
      do add(x + v, y + v);
      while (!kOne && (v += w) < vectors * w);
      x += x_step, y += y_step;
    } while (--positions > 0);
  } while (++span != end);
#pragma GCC unroll 8
  for (int r = 0; r < R; ++r)
#pragma GCC unroll 8
    for (int q = 0; q < kInputs; ++q)
      store(sums + r * sums_step + q * wide, acc[r][q]);
}

/// Inputs [k, k + Q) with all outputs.
template <class T, class V, int Q>
void weight_rows(const Sweep<T>& g, Index k) {
  Index o = 0;
  const auto step = [&]<int R>() {
    if (g.stride == sizeof(V) / sizeof(T)) {
      weight_tile<T, V, R, Q, true>(g, o, k);
    } else {
      weight_tile<T, V, R, Q, false>(g, o, k);
    }
    o += R;
  };
  while (o + kOutTile <= g.out) step.template operator()<kOutTile>();
  if constexpr (kOutTile > 4)
    while (o + 4 <= g.out) step.template operator()<4>();
  while (o < g.out) step.template operator()<1>();
}

/// Inputs [0, depth) with all outputs.
template <class T, class V>
void weight_columns(const Sweep<T>& g, Index depth) {
  Index k = 0;
  const auto step = [&]<int Q>() {
    weight_rows<T, V, Q>(g, k);
    k += Q;
  };
  // Rather twice 4 than 6 and 2, twice 2 than 3 and 1.
  constexpr int kNext = kInTile > 3 ? 4 : 2;
  while (k + kInTile <= depth && depth - k != 2 * kNext)
    step.template operator()<kInTile>();
  while (k + kNext <= depth) step.template operator()<kNext>();
  if constexpr (kNext > 3)
    while (k + 3 <= depth) step.template operator()<3>();
  while (k < depth) step.template operator()<1>();
}

/// Positions [begin, end) tap by tap: a tile holds its sums across the edges of
/// a plane's rows.
template <class T, class V>
void weights_by_tap(Sweep<T> g,
                    const ConvShape& shape,
                    const WindowRun* run,
                    const WindowRun* last,
                    Index begin,
                    Index end) {
  Span spans[kMostSpans];
  T* const sums = g.sums;
  for (Index tap = 0; tap < shape.taps.count(); ++tap) {
    Span* next = spans;
    for (const WindowRun* r = run; r != last && r->first < end; ++r) {
      Span span = part_of(*r, begin, end);
      for (const Segment& s : r->segments) {
        if (tap < s.tap || tap >= s.tap + s.taps) continue;
        span.shift = s.shift + tap - s.tap;
        const bool goes_on = next != spans && next[-1].shift == span.shift &&
                             next[-1].first + next[-1].count == span.first;
        if (goes_on) {
          next[-1].count += span.count;
        } else {
          *next++ = span;
        }
      }
    }
    if (next == spans) continue;
    g.spans = spans, g.span_count = next - spans;
    g.sums = sums + tap * shape.in * static_cast<Index>(sizeof(V) / sizeof(T));
    weight_columns<T, V>(g, shape.in);
  }
}

/// The same run by run: inputs of neighbouring taps share tiles.
template <class T, class V>
void weights_by_run(Sweep<T> g,
                    const ConvShape& shape,
                    const WindowRun* run,
                    const WindowRun* last,
                    Index begin,
                    Index end) {
  constexpr Index w = sizeof(V) / sizeof(T);
  T* const sums = g.sums;
  for (; run != last && run->first < end; ++run) {
    Span span = part_of(*run, begin, end);
    g.spans = &span, g.span_count = 1;
    for (const Segment& s : run->segments) {
      span.shift = s.shift;
      g.sums = sums + s.tap * shape.in * w;
      weight_columns<T, V>(g, s.taps * shape.in);
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
                        const std::vector<WindowRun>& runs,
                        Rows<const T> x,
                        Rows<const T> y_bar,
                        Index begin,
                        Index end,
                        T* sums) {
  using V = NarrowPack<T>;
  constexpr Index w = kNarrowLanes<T>;
  const Index vectors = x.width / w, in = shape.in, out = shape.out;
  if (vectors == 0) return;
  // y_bar's part stays in the L1 while all inputs pass by; with many outputs
  // in the L2, as a tile's sums must not come and go too often.
  const Index budget =
      std::max<Index>(16, kWeightBytes / (out * static_cast<Index>(sizeof(V))));
  const Index per_row = std::min(vectors, budget);
  const Index per_block = std::min(budget / per_row, kMostSpans);
  const auto sweep = vectors < kFewVectors && in > kInTile
                         ? weights_by_tap<T, V>
                         : weights_by_run<T, V>;
  const WindowRun* run = runs.data();
  const WindowRun* const last = run + runs.size();
  for (Index p = begin; p < end; p += per_block) {
    const Index stop = std::min(end, p + per_block);
    run = std::partition_point(
        run, last, [&](const WindowRun& r) { return r.first + r.count <= p; });
    for (Index v = 0; v < vectors; v += per_row)
      sweep({.spans = nullptr,
             .span_count = 0,
             .x = x.data + v * w,
             .y = y_bar.data + v * w,
             .x_step = in * x.stride,
             .y_step = out * x.stride,
             .stride = x.stride,
             .vectors = std::min(per_row, vectors - v),
             .out = out,
             .sums = sums,
             .sums_step = shape.depth() * w},
            shape,
            run,
            last,
            p,
            stop);
  }
}

template <class T>
void add_weights(const ConvShape& shape, const T* sums, T* totals) {
  add_lanes(sums, kNarrowLanes<T>, shape.weights(), totals);
}

template <class T>
void order_weights(const ConvShape& shape, const T* totals, T* weights_bar) {
  const Index taps = shape.taps.count(), in = shape.in, depth = shape.depth();
  for (Index o = 0; o < shape.out; ++o)
    for (Index t = 0; t < taps; ++t)
      for (Index c = 0; c < in; ++c)
        weights_bar[(o * in + c) * taps + t] = totals[o * depth + t * in + c];
}

template <class T>
Index positions_per_block(Rows<const T> x, Index channels) {
  const Index bytes = channels * x.stride * static_cast<Index>(sizeof(T));
  return std::max<Index>(1, kBlockBytes / bytes);
}

#define PHYSINV_INSTANTIATE(T)                                    \
  template decltype(weight_sums<T>) weight_sums<T>;               \
  template decltype(accumulate_weights<T>) accumulate_weights<T>; \
  template decltype(add_weights<T>) add_weights<T>;               \
  template decltype(order_weights<T>) order_weights<T>;           \
  template decltype(positions_per_block<T>) positions_per_block<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
