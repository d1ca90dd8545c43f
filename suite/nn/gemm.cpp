#include "suite/nn/gemm.h"

#include <algorithm>
#include <cstddef>

#include "suite/core/simd/pack.h"
#include "suite/nn/activation.h"
#include "suite/nn/thin_product.h"

namespace physinv::nn {
namespace {

// Register tiles of rows x vectors. Twelve accumulators fill the sixteen
// registers of AVX2, and hide the latency of two FMA units (8 in flight).
#if defined(PHYSINV_AVX512)
template <class T>
constexpr int kRows2 = 8;
constexpr int kRows1 = 16;
#elif defined(__aarch64__)
// There a vector takes two of 32.
template <class T>
constexpr int kRows2 = sizeof(T) == 4 ? 6 : 4;
constexpr int kRows1 = 8;
#else
template <class T>
constexpr int kRows2 = 6;
constexpr int kRows1 = 12;
#endif
constexpr Index kDepth = 256;    ///< k per round: a panel of B stays in the L1
constexpr Index kRowBlock = 16;  ///< rows of one block of the thread loop
constexpr Index kPanel = 48;     ///< rows of tiles finished together
constexpr Index kNear = 16384;   ///< bytes of C that are still in the L1
constexpr Index kGroup = 4;      ///< vectors whose function is taken together
/// Below it, what goes from core to core takes longer than half of the product.
constexpr double kThreadFlops = 16e6;

/// Part of C: rows from i, `valid` columns from j, products k0..k1.
struct Part {
  Index i, j, k0, k1, valid;
};

/// How a finished tile leaves the registers. Others are done in memory, a panel
/// of tiles at a time, while it is in the L1: their code does not spill the
/// accumulators, and sets up its constants once.
enum class Store { plain, relu, relu_gate, tanh_gate, in_memory };

template <class T>
Store store_of(const Gemm<T>& g) {
  const bool free = g.activation == Activation::identity;
  const bool open = g.gate_activation == Activation::identity;
  if (free && open) return Store::plain;
  if (open && g.activation == Activation::relu) return Store::relu;
  if (free && g.gate_activation == Activation::relu) return Store::relu_gate;
  if (free && g.gate_activation == Activation::tanh) return Store::tanh_gate;
  return Store::in_memory;
}

/// Lanes of rows from i, columns from j <- f(row, column, lanes, how many).
template <class T, class F>
[[gnu::always_inline]] inline void for_vectors(
    const Gemm<T>& g, Index i, Index end, Index j, Index cols, F&& f) {
  using V = NarrowPack<T>;
  for (Index r = i; r < end; ++r) {
    T* const row = g.c + r * g.c_stride;
    Index c = j;
    for (; c + kNarrowLanes<T> <= j + cols; c += kNarrowLanes<T>)
      store(row + c, f(r, c, load<V>(row + c), kNarrowLanes<T>));
    if (const Index some = j + cols - c; some > 0)
      store_some(row + c, f(r, c, load_some<V>(row + c, some), some), some);
  }
}

/// A function of a panel, of several rows at a time. What is missing in the
/// last group repeats its last row.
template <class T, class F>
[[gnu::noinline]] void for_groups(
    T* c, Index stride, Index rows, Index cols, F&& of_group) {
  using V = NarrowPack<T>;
  for (Index j = 0; j < cols; j += kNarrowLanes<T>) {
    const Index width = std::min(kNarrowLanes<T>, cols - j);
    for (Index r = 0; r < rows; r += kGroup) {
      const Index last = std::min(kGroup, rows - r) - 1;
      T* const from = c + r * stride + j;
      V v[kGroup];
#pragma GCC unroll 8
      for (Index q = 0; q < kGroup; ++q)
        v[q] = load_lanes<V>(from + std::min(q, last) * stride, width);
      of_group(v);
#pragma GCC unroll 8
      for (Index q = 0; q < kGroup; ++q)
        if (q <= last) store_lanes(from + q * stride, v[q], width);
    }
  }
}

/// The activation and the gate of a panel, in memory.
template <class T>
[[gnu::noinline]] void finish(
    const Gemm<T>& g, Index i, Index end, Index j, Index cols) {
  using V = NarrowPack<T>;
  T* const panel = g.c + i * g.c_stride + j;
  if (g.activation == Activation::tanh)
    for_groups(
        panel, g.c_stride, end - i, cols, [](auto& v) { tanh_lanes(v); });
  else if (g.activation == Activation::sigmoid)
    for_groups(
        panel, g.c_stride, end - i, cols, [](auto& v) { sigmoid_lanes(v); });
  else if (g.activation != Activation::identity)
    for_vectors(g, i, end, j, cols, [&](Index, Index, V v, Index) {
      return activate_lanes<T>(g.activation, v);
    });
  if (g.gate == nullptr) return;
  for_vectors(g, i, end, j, cols, [&](Index r, Index c, V v, Index some) {
    const V gate = load_lanes<V>(g.gate + r * g.gate_stride + c, some);
    return pull_lanes<T>(g.gate_activation, gate, v);
  });
}

/// Numbers of a vector, fewer than it holds if not kWhole.
template <class T, class V, bool kWhole>
struct Vectors {
  static constexpr Index w = sizeof(V) / sizeof(T);
  Index count;

  [[gnu::always_inline]] V get(const T* from) const {
    return kWhole ? load<V>(from) : load_some<V>(from, count);
  }
  [[gnu::always_inline]] void put(T* to, V v) const {
    if constexpr (kWhole) {
      store(to, v);
    } else {
      store_some(to, v, count);
    }
  }
};

/// The sums of a tile before its products: what is there, the bias, or zero.
template <class T, class V, int M, int N, bool kWhole>
[[gnu::always_inline]] inline void begin_sums(const Gemm<T>& g,
                                              const Part& p,
                                              Vectors<T, V, kWhole> vectors,
                                              V (&acc)[M][N]) {
#pragma GCC unroll 16
  for (int r = 0; r < M; ++r)
#pragma GCC unroll 2
    for (int c = 0; c < N; ++c) acc[r][c] = V{};
  const T* const from = g.c + p.i * g.c_stride + p.j;
  if (p.k0 > 0) {
#pragma GCC unroll 16
    for (int r = 0; r < M; ++r)
#pragma GCC unroll 2
      for (int c = 0; c < N; ++c)
        acc[r][c] = vectors.get(from + r * g.c_stride + c * vectors.w);
  } else if (g.bias != nullptr) {
#pragma GCC unroll 16
    for (int r = 0; r < M; ++r)
#pragma GCC unroll 2
      for (int c = 0; c < N; ++c) acc[r][c] = broadcast<V>(g.bias[p.i + r]);
  }
}

/// What is done to the finished sums in registers, and the sums to memory.
template <class T, class V, int M, int N, bool kWhole>
[[gnu::always_inline]] inline void end_sums(const Gemm<T>& g,
                                            const Part& p,
                                            Vectors<T, V, kWhole> vectors,
                                            V (&acc)[M][N]) {
  constexpr Index w = vectors.w;
  const auto gate = [&](Activation kind) {
    const T* y = g.gate + p.i * g.gate_stride + p.j;
#pragma GCC unroll 16
    for (int r = 0; r < M; ++r)
#pragma GCC unroll 2
      for (int c = 0; c < N; ++c)
        acc[r][c] = pull_lanes<T>(
            kind, vectors.get(y + r * g.gate_stride + c * w), acc[r][c]);
  };
  const Store how = p.k1 == g.k ? store_of(g) : Store::plain;
  if (how == Store::relu) {
#pragma GCC unroll 16
    for (int r = 0; r < M; ++r)
#pragma GCC unroll 2
      for (int c = 0; c < N; ++c)
        acc[r][c] = activate_lanes<T>(Activation::relu, acc[r][c]);
  } else if (how == Store::relu_gate) {
    gate(Activation::relu);
  } else if (how == Store::tanh_gate) {
    gate(Activation::tanh);
  }
  T* const to = g.c + p.i * g.c_stride + p.j;
#pragma GCC unroll 16
  for (int r = 0; r < M; ++r)
#pragma GCC unroll 2
    for (int c = 0; c < N; ++c)
      vectors.put(to + r * g.c_stride + c * w, acc[r][c]);
}

/// M rows x N vectors in registers. kUnit: a_row is 1, known to the compiler.
template <class T, class V, int M, int N, bool kUnit, bool kWhole>
[[gnu::noinline]] void tile(const Gemm<T>& g, const Part& p) {
  constexpr Index w = sizeof(V) / sizeof(T);
  const Index a_row = kUnit ? 1 : g.a_row;
  const Vectors<T, V, kWhole> vectors{p.valid};
  V acc[M][N];
  begin_sums(g, p, vectors, acc);
  constexpr int groups = (M + 3) / 4;
  const T* a[groups];
#pragma GCC unroll 4
  for (int q = 0; q < groups; ++q)
    a[q] = g.a + (p.i + 4 * q) * a_row + p.k0 * g.a_k;
  const T* b = g.b + p.k0 * g.b_stride + p.j;
  for (Index k = p.k0; k < p.k1; ++k, b += g.b_stride) {
    V bv[N];
#pragma GCC unroll 2
    for (int c = 0; c < N; ++c) bv[c] = held(load<V>(b + c * w));
#pragma GCC unroll 16
    for (int r = 0; r < M; ++r) {
      const V s = broadcast<V>(a[r / 4][(r % 4) * a_row]);
#pragma GCC unroll 2
      for (int c = 0; c < N; ++c) acc[r][c] = fma_lanes(s, bv[c], acc[r][c]);
    }
#pragma GCC unroll 4
    for (int q = 0; q < groups; ++q) a[q] += g.a_k;
  }
  end_sums(g, p, vectors, acc);
}

/// All rows of one column of tiles, the remainder by smaller ones.
template <class T, class V, int M, int N, bool kUnit, bool kWhole = true>
void column(const Gemm<T>& g, Part p, Index end) {
  for (; p.i + M <= end; p.i += M) tile<T, V, M, N, kUnit, kWhole>(g, p);
  if constexpr (M > 1) {
    if (p.i < end) column<T, V, M - 1, N, kUnit, kWhole>(g, p, end);
  }
}

/// Whether so many rows are finished when all of them are there.
template <class T>
bool near(const Gemm<T>& g, Index rows) {
  return rows * g.n * static_cast<Index>(sizeof(T)) <= kNear;
}

/// The same with what is left to do in memory, unless that comes last.
template <class T, class V, int M, int N, bool kUnit, bool kWhole = true>
void panels(const Gemm<T>& g, Part p, Index end) {
  const bool finishes =
      p.k1 == g.k && store_of(g) == Store::in_memory && !near(g, end - p.i);
  for (Index next; p.i < end; p.i = next) {
    next = finishes ? std::min(p.i + kPanel, end) : end;
    column<T, V, M, N, kUnit, kWhole>(g, p, next);
    if (finishes) finish(g, p.i, next, p.j, p.valid);
  }
}

template <class T, bool kUnit>
void rows(const Gemm<T>& g, Index begin, Index end) {
  using V = Pack<T>;
  using N = NarrowPack<T>;
  constexpr Index wide = kLanes<T>, narrow = kNarrowLanes<T>;
  Index k0 = 0;
  do {
    const Index k1 = std::min(k0 + kDepth, g.k);
    Index j = 0;
    for (; j + 2 * wide <= g.n; j += 2 * wide)
      panels<T, V, kRows2<T>, 2, kUnit>(g, {begin, j, k0, k1, 2 * wide}, end);
    for (; j + wide <= g.n; j += wide)
      panels<T, V, kRows1, 1, kUnit>(g, {begin, j, k0, k1, wide}, end);
    for (; j + narrow <= g.n; j += narrow)
      panels<T, N, kRows1, 1, kUnit>(g, {begin, j, k0, k1, narrow}, end);
    if (j < g.n)
      panels<T, N, kRows1, 1, kUnit, false>(
          g, {begin, j, k0, k1, g.n - j}, end);
    k0 = k1;
  } while (k0 < g.k);
  if (store_of(g) == Store::in_memory && near(g, end - begin))
    finish(g, begin, end, 0, g.n);
}

template <class T>
void rows(const Gemm<T>& g, Index begin, Index end) {
  if (g.a_row == 1) {
    rows<T, true>(g, begin, end);
  } else {
    rows<T, false>(g, begin, end);
  }
}

}  // namespace

template <class T>
void gemm(const Gemm<T>& g, Threads* threads) {
  if (is_thin(g)) return thin_product(g);
  const double flops = 2.0 * static_cast<double>(g.m * g.n * g.k);
  if (threads == nullptr || threads->count() == 1 || flops < kThreadFlops) {
    rows(g, 0, g.m);
    return;
  }
  for_blocks(threads, (g.m + kRowBlock - 1) / kRowBlock, [&](Index block, int) {
    const Index begin = block * kRowBlock;
    rows(g, begin, std::min(begin + kRowBlock, g.m));
  });
}

template void gemm<float>(const Gemm<float>&, Threads*);
template void gemm<double>(const Gemm<double>&, Threads*);

}  // namespace physinv::nn
