#include "suite/linalg/symmetric_update.h"

#include <algorithm>
#include <cmath>

#include "suite/core/threads.h"
#include "suite/linalg/panel_parts.h"
#include "suite/linalg/tile_product.h"

namespace physinv::linalg {
namespace {

constexpr Index kMaxParts = 8;
constexpr Index kPartRows = 192;  ///< of a part, at least
constexpr Index kColumnBlock = 128;
constexpr Index kPacked = 128;     ///< rows and columns that a thread packs
constexpr Index kPackedRows = 16;  ///< at once: they stay in the L1

/// kCount registers from column c on of kRows rows: y += A x for the stored
/// entries, dot for the mirrored ones. Where a register has only a part of
/// eight numbers, part by part: x, y, an entry and all of s and dot then fit
/// into 16 of them.
template <int kRows, int kCount>
[[gnu::always_inline]] inline void add_columns(const double* rows,
                                               Index stride,
                                               Index c,
                                               const double* x,
                                               double* y,
                                               const Part* s,
                                               Part (&dot)[kRows][kParts]) {
  constexpr int kAtOnce = kParts == 1 ? kCount : 1;
#pragma GCC unroll 4
  for (int part = 0; part < kCount * kParts; part += kAtOnce) {
    Part xc[kAtOnce], yc[kAtOnce];
    const Index at = c + part * kPartWidth;
#pragma GCC unroll 2
    for (int k = 0; k < kAtOnce; ++k) {
      xc[k] = held(physinv::load<Part>(x + at + k * kPartWidth));
      yc[k] = physinv::load<Part>(y + at + k * kPartWidth);
    }
#pragma GCC unroll 4
    for (int i = 0; i < kRows; ++i)
#pragma GCC unroll 2
      for (int k = 0; k < kAtOnce; ++k) {
        const Part v =
            held(physinv::load<Part>(rows + i * stride + at + k * kPartWidth));
        Part& along = dot[i][(part + k) % kParts];
        yc[k] = fma_lanes(v, s[i], yc[k]);
        along = fma_lanes(v, xc[k], along);
      }
#pragma GCC unroll 2
    for (int k = 0; k < kAtOnce; ++k) store(y + at + k * kPartWidth, yc[k]);
  }
}

template <int kRows>
[[gnu::always_inline]] inline void add_rows(Symmetric a,
                                            Index r,
                                            const double* x,
                                            double* y) {
  const double* const rows = a.row(r);
  for (Index i = 0; i < kRows; ++i) {
    const double* row = rows + i * a.stride;
    y[r + i] = std::fma(row[r + i], x[r + i], y[r + i]);
    for (Index j = i + 1; j < kRows; ++j) {
      y[r + i] = std::fma(row[r + j], x[r + j], y[r + i]);
      y[r + j] = std::fma(row[r + j], x[r + i], y[r + j]);
    }
  }
  Part dot[kRows][kParts] = {}, s[kRows];
#pragma GCC unroll 4
  for (int i = 0; i < kRows; ++i) s[i] = physinv::broadcast<Part>(x[r + i]);
  Index c = r + kRows;
  for (; c + kWidth < a.n; c += 2 * kWidth)
    add_columns<kRows, 2>(rows, a.stride, c, x, y, s, dot);
  if (c < a.n) add_columns<kRows, 1>(rows, a.stride, c, x, y, s, dot);
#pragma GCC unroll 4
  for (int i = 0; i < kRows; ++i) y[r + i] += sum_of(from_parts(dot[i]));
}

enum class Way { down, up };

/// Rows [begin, end): y += A x for the stored and mirrored entries; four rows
/// at a time from a multiple of four on, so that few loads cross a cache line.
void add_product(
    Symmetric a, Index begin, Index end, Way way, const double* x, double* y) {
  const Index head = std::min(round_up(begin, 4), end);
  const Index tail = std::max(head, end / 4 * 4);
  if (way == Way::down) {
    for (Index r = begin; r < head; ++r) add_rows<1>(a, r, x, y);
    for (Index r = head; r < tail; r += 4) add_rows<4>(a, r, x, y);
    for (Index r = tail; r < end; ++r) add_rows<1>(a, r, x, y);
  } else {
    for (Index r = end; r-- > tail;) add_rows<1>(a, r, x, y);
    for (Index r = tail; r > head;) add_rows<4>(a, r -= 4, x, y);
    for (Index r = head; r-- > begin;) add_rows<1>(a, r, x, y);
  }
}

}  // namespace

Index padded_stride(Index n) {
  // The kernels may run one register beyond a row's last tile.
  const Index lines = (n + kTileColumns + kWidth + 15) / 16;
  return 16 * (lines | 1);
}

void SymmetricProduct::operator()(
    Symmetric a, Index first, const double* x, double* y, Threads* threads) {
  const Index n = a.n - first;
  const Index parts =
      n < kThreadRows ? 1 : std::clamp<Index>(n / kPartRows, 1, kMaxParts);
  // A row shorter, back the way that the last product came: what it left in
  // the cache is used first.
  const Way way = first % 2 == 0 ? Way::down : Way::up;
  const Index length = round_up(n, kWidth) + kWidth;
  std::fill(y + first, y + first + length, 0.0);
  if (parts == 1) {
    add_product(a, first, a.n, way, x, y);
    return;
  }
  // Equal areas: the rows before part p hold the share p / parts.
  const auto begin = [&](Index p) {
    if (p == parts) return n;
    const double left =
        std::sqrt(1 - static_cast<double>(p) / static_cast<double>(parts));
    return static_cast<Index>(static_cast<double>(n) * (1 - left)) / 4 * 4;
  };
  if (static_cast<Index>(parts_.size()) < kMaxParts * a.stride)
    parts_.resize(static_cast<std::size_t>(kMaxParts * a.stride));
  for_blocks(threads, parts, [&](Index p, int) {
    double* to = p == 0 ? y : parts_.data() + p * a.stride;
    const Index from = first + begin(p);
    if (p > 0) std::fill(to + from, to + first + length, 0.0);
    add_product(a, from, first + begin(p + 1), way, x, to);
  });
  for (Index p = 1; p < parts; ++p) {
    const double* part = parts_.data() + p * a.stride;
    for (Index c = first + begin(p); c < a.n; ++c) y[c] += part[c];
  }
}

void RankUpdate::operator()(Symmetric a,
                            Index first,
                            const double* v,
                            const double* w,
                            Index stride,
                            Index count,
                            Threads* threads) {
  const Index n = a.n - first;
  if (n <= 0) return;
  const Index depth = 2 * count,
              groups = round_up(n, kTileColumns) / kTileColumns;
  rows_.resize(std::max(rows_.size(), static_cast<std::size_t>(n * depth)));
  columns_.resize(
      std::max(columns_.size(),
               static_cast<std::size_t>(groups * depth * kTileColumns)));
  // Row r reads [-W V](r, :), column group q reads [V W](q, :), both packed.
  for_blocks(threads, (n + kPacked - 1) / kPacked, [&](Index pack, int) {
    const Index begin = pack * kPacked, end = std::min(begin + kPacked, n);
    for (Index from = begin; from < end; from += kPackedRows) {
      const Index to = std::min(from + kPackedRows, end);
      for (Index k = 0; k < count; ++k)
        for (Index r = from; r < to; ++r) {
          double* const row = rows_.data() + r * depth + k;
          row[0] = -w[k * stride + first + r];
          row[count] = -v[k * stride + first + r];
        }
    }
    for (Index q = begin / kTileColumns; q * kTileColumns < end; ++q)
      for (Index k = 0; k < depth; ++k) {
        const double* from =
            (k < count ? v + k * stride : w + (k - count) * stride) + first +
            q * kTileColumns;
        double* to = columns_.data() + (q * depth + k) * kTileColumns;
        store(to, load(from));
        store(to + kWidth, load(from + kWidth));
      }
  });
  const PanelParts parts(n);
  const Index pieces = threads != nullptr && parts.count() > 1 ? 2 : 1;
  for_blocks(threads, parts.count() * pieces, [&](Index part, int) {
    const Index from = parts.begin(part, pieces);
    const Index to = parts.begin(part + 1, pieces);
    for (Index begin = from / kColumnBlock * kColumnBlock; begin < n;
         begin += kColumnBlock) {
      const Index end = std::min(begin + kColumnBlock, n);
      for (Index r0 = from; r0 < std::min(to, end); r0 += kTileRows) {
        const Index some = std::min<Index>(kTileRows, to - r0);
        Index q = std::max(begin, r0) / kTileColumns;
        for (; q * kTileColumns < end; ++q)
          tile_rows(some,
                    depth,
                    {rows_.data() + r0 * depth, depth, 1},
                    columns_.data() + q * depth * kTileColumns,
                    kTileColumns,
                    [&](Index r, Pack8 x, Pack8 y) {
                      double* to_row =
                          a.row(first + r0 + r) + first + q * kTileColumns;
                      store(to_row, load(to_row) + x);
                      store(to_row + kWidth, load(to_row + kWidth) + y);
                    });
      }
    }
  });
}

}  // namespace physinv::linalg
