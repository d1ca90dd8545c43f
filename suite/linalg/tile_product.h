/// Register tiles for the level-3 parts of the half-inverse: kRows broadcast
/// numbers against two vectors. Every output adds its products one by one in
/// the order of k by fused multiply-add, so its bits depend neither on the
/// tile it falls into nor on threads.
#pragma once

#include "suite/linalg/eight.h"

namespace physinv::linalg {

inline constexpr Index kTileColumns = 2 * kWidth;  ///< of one tile
/// With two vectors each, accumulators for 32 registers of 512 bits, or, as a
/// vector takes two of them, for 16 of 256.
inline constexpr int kTileRows = kVectorBytes == 64 ? 8 : 3;

/// a[r * row + k * step], read as single numbers.
struct Scalars {
  const double* data;
  Index row, step;
};

/// acc[r] += s[r] b for M rows of two vectors. Registers of 512 bits hold b,
/// and products take their factors from memory; among 16 of 256 bits there is
/// room for the factors and one part of b.
template <int M>
[[gnu::always_inline]] inline void add_outer(const double* s,
                                             Index row,
                                             const double* b,
                                             Part (&acc)[M][2 * kParts]) {
  if constexpr (kParts == 1) {
    const Part first = held(physinv::load<Part>(b)),
               second = held(physinv::load<Part>(b + kWidth));
#pragma GCC unroll 8
    for (int r = 0; r < M; ++r) {
      const Part factor = physinv::broadcast<Part>(s[r * row]);
      acc[r][0] = fma_lanes(factor, first, acc[r][0]);
      acc[r][1] = fma_lanes(factor, second, acc[r][1]);
    }
  } else {
    Part factor[M];
#pragma GCC unroll 8
    for (int r = 0; r < M; ++r)
      factor[r] = held(physinv::broadcast<Part>(s[r * row]));
#pragma GCC unroll 4
    for (int c = 0; c < 2 * kParts; ++c) {
      const Part v = held(physinv::load<Part>(b + c * kPartWidth));
#pragma GCC unroll 8
      for (int r = 0; r < M; ++r)
        acc[r][c] = fma_lanes(factor[r], v, acc[r][c]);
    }
  }
}

/// finish(r, first, second) gets sum_k a(r, k) b[k][0..kTileColumns) for
/// r < M; b has `b_step` numbers from one k to the next.
template <int M, class Finish>
[[gnu::always_inline]] inline void tile(
    Index depth, Scalars a, const double* b, Index b_step, Finish&& finish) {
  Part acc[M][2 * kParts];
#pragma GCC unroll 8
  for (int r = 0; r < M; ++r)
#pragma GCC unroll 4
    for (int c = 0; c < 2 * kParts; ++c) acc[r][c] = Part{};
  const double* at = a.data;
  for (Index k = 0; k < depth; ++k, at += a.step, b += b_step)
    add_outer(at, a.row, b, acc);
#pragma GCC unroll 8
  for (int r = 0; r < M; ++r)
    finish(r, from_parts(acc[r]), from_parts(acc[r] + kParts));
}

/// The same for any number of rows.
template <int M = kTileRows, class Finish>
inline void tile_rows(Index rows,
                      Index depth,
                      Scalars a,
                      const double* b,
                      Index b_step,
                      Finish&& finish) {
  Index i = 0;
  for (; i + M <= rows; i += M)
    tile<M>(depth,
            {a.data + i * a.row, a.row, a.step},
            b,
            b_step,
            [&](int r, Pack8 x, Pack8 y) { finish(i + r, x, y); });
  if constexpr (M > 1) {
    if (i < rows)
      tile_rows<M - 1>(rows - i,
                       depth,
                       {a.data + i * a.row, a.row, a.step},
                       b,
                       b_step,
                       [&](Index r, Pack8 x, Pack8 y) { finish(i + r, x, y); });
  }
}

enum class Into { set, add };

/// C (rows x columns, rows c_row apart) = or += A B. `columns` is a multiple
/// of kTileColumns.
template <Into kInto>
void multiply(Index rows,
              Index columns,
              Index depth,
              Scalars a,
              const double* b,
              Index b_step,
              double* c,
              Index c_row) {
  for (Index j = 0; j < columns; j += kTileColumns)
    tile_rows(rows, depth, a, b + j, b_step, [&](Index r, Pack8 x, Pack8 y) {
      double* to = c + r * c_row + j;
      if constexpr (kInto == Into::add) x += load(to), y += load(to + kWidth);
      store(to, x);
      store(to + kWidth, y);
    });
}

}  // namespace physinv::linalg
