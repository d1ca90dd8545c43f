#include "optimizers/half_inverse/structured_gram.h"

#include <algorithm>
#include <utility>

#include "optimizers/half_inverse/tile_product.h"
#include "suite/core/check.h"

namespace physinv::hig {
namespace {

/// Rows of a tile; a divisor of kTileColumns, so that a packed group serves as
/// rows and as columns.
constexpr int kRows = static_cast<int>(kTileColumns) / 2;
constexpr Index kBlock = 64;  ///< columns of a block: factors stay in the L1

double* at(std::vector<double>& v, Index i) { return v.data() + i; }

void grow(std::vector<double>& v, Index size) {
  if (static_cast<Index>(v.size()) < size)
    v.resize(static_cast<std::size_t>(size));
}

}  // namespace

/// Groups of kTileColumns rows of all B, [group][feature][row], zero behind
/// the end; and the factors A^T A + 1 of every layer.
template <class T>
void StructuredGram::pack(std::span<const GramLayer<T>> layers,
                          Index samples,
                          Index rows) {
  begin_.assign(1, 0);
  for (const auto& layer : layers)
    begin_.push_back(begin_.back() + layer.outputs);
  const Index features = begin_.back();
  const Index groups = round_up(rows, kTileColumns) / kTileColumns;
  grow(packed_, groups * features * kTileColumns);
  const Index stride = round_up(samples, kTileColumns);
  grow(factors_, static_cast<Index>(layers.size()) * samples * stride);
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const GramLayer<T>& layer = layers[l];
    for (Index q = 0; q < groups; ++q) {
      const Index first = q * kTileColumns;
      const Index some = std::min(kTileColumns, rows - first);
      for (Index o = 0; o < layer.outputs; ++o) {
        const T* from = layer.b + o * layer.b_stride + first;
        double* to = at(packed_, (q * features + begin_[l] + o) * kTileColumns);
        for (Index i = 0; i < some; ++i) to[i] = static_cast<double>(from[i]);
        std::fill(to + some, to + kTileColumns, 0.0);
      }
    }
    grow(inputs_, layer.inputs * stride);
    for (Index i = 0; i < layer.inputs; ++i)
      for (Index s = 0; s < stride; ++s)
        inputs_[static_cast<std::size_t>(i * stride + s)] =
            s < samples ? static_cast<double>(layer.a[i * layer.a_stride + s])
                        : 0.0;
    double* factor = at(factors_, static_cast<Index>(l) * samples * stride);
    multiply<Into::set>(samples,
                        stride,
                        layer.inputs,
                        {inputs_.data(), 1, stride},
                        inputs_.data(),
                        stride,
                        factor,
                        stride);
    if (layer.bias)
      for (Index i = 0; i < samples * stride; ++i) factor[i] += 1;
  }
}

template <class T>
void StructuredGram::operator()(std::span<const GramLayer<T>> layers,
                                Index samples,
                                Index rows_per_sample,
                                BatchOut<double> gram,
                                Threads* threads) {
  const Index m = samples * rows_per_sample;
  SUITE_CHECK(gram.rows() == m && gram.cols() == m, "G is m x m");
  if (m == 0) return;
  pack(layers, samples, m);
  const Index features = begin_.back();
  const auto count = static_cast<Index>(layers.size());
  const Index stride = round_up(samples, kTileColumns);
  const Index blocks = (m + kBlock - 1) / kBlock;
  expanded_.resize(
      static_cast<std::size_t>(threads == nullptr ? 1 : threads->count()));
  for (auto& e : expanded_) grow(e, kRows * count * kBlock);

  // Memory row r of G (its column r) from c = r on; the largest blocks first.
  for_blocks(threads, blocks, [&](Index reversed, int thread) {
    double* const expanded = expanded_[static_cast<std::size_t>(thread)].data();
    const Index begin = (blocks - 1 - reversed) * kBlock;
    const Index end = std::min(begin + kBlock, m);
    Index from = -1, to = -1;  // samples whose factors are in `expanded`
    for (Index r0 = 0; r0 < end; r0 += kRows) {
      const Index first = r0 / rows_per_sample;
      const Index last = std::min(r0 + kRows, m) - 1;
      if (first != from || last / rows_per_sample > to) {
        from = first, to = last / rows_per_sample;
        for (Index s = from; s <= to; ++s)
          for (Index l = 0; l < count; ++l) {
            const double* factor = at(factors_, (l * samples + s) * stride);
            double* e = expanded + ((s - from) * count + l) * kBlock;
            Index other = begin / rows_per_sample;
            Index k = begin % rows_per_sample;
            for (Index c = 0; c < kBlock; ++c) {
              e[c] = begin + c < m ? factor[other] : 0.0;
              if (++k == rows_per_sample) k = 0, ++other;
            }
          }
      }
      const double* of_row[kRows];
      for (Index r = 0; r < kRows; ++r)
        of_row[r] =
            expanded +
            (std::min(r0 + r, last) / rows_per_sample - from) * count * kBlock;
      const double* const row_pack =
          at(packed_, r0 / kTileColumns * features * kTileColumns) +
          r0 % kTileColumns;
      Index c = std::max(begin, r0 / kTileColumns * kTileColumns);
      for (; c < end; c += kTileColumns) {
        const double* const column_pack = at(packed_, c * features);
        Wide total[kRows][2] = {};
        for (Index l = 0; l < count; ++l) {
          const Index skip = begin_[static_cast<std::size_t>(l)];
          const Index depth = layers[static_cast<std::size_t>(l)].outputs;
          tile<kRows>(depth,
                      {row_pack + skip * kTileColumns, 1, kTileColumns},
                      column_pack + skip * kTileColumns,
                      kTileColumns,
                      [&](int r, Wide x, Wide y) {
                        const double* e = of_row[r] + l * kBlock + c - begin;
                        total[r][0] = fma(x, load(e), total[r][0]);
                        total[r][1] = fma(y, load(e + kWidth), total[r][1]);
                      });
        }
        if (c >= r0 + kRows - 1 && c + kTileColumns <= m) {
#pragma GCC unroll 8
          for (int r = 0; r < kRows; ++r) {
            double* out = &gram(c, r0 + r);
            store(out, total[r][0]);
            store(out + kWidth, total[r][1]);
          }
          continue;
        }
        for (Index r = r0; r <= last; ++r) {
          double row[kTileColumns];
          store(row, total[r - r0][0]);
          store(row + kWidth, total[r - r0][1]);
          for (Index i = std::max(c, r); i < std::min(c + kTileColumns, m); ++i)
            gram(i, r) = row[i - c];
        }
      }
    }
  });
}

template void StructuredGram::operator()<float>(
    std::span<const GramLayer<float>>,
    Index,
    Index,
    BatchOut<double>,
    Threads*);
template void StructuredGram::operator()<double>(
    std::span<const GramLayer<double>>,
    Index,
    Index,
    BatchOut<double>,
    Threads*);

}  // namespace physinv::hig
