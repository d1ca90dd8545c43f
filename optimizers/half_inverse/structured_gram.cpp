#include "optimizers/half_inverse/structured_gram.h"

#include <algorithm>
#include <cmath>
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

/// Features packed at once: the columns of a block stay in the L2.
constexpr Index kMostFeatures = 1280;

template <class T>
Index packed_features(const GramLayer<T>& layer) {
  return layer.written_out() ? layer.columns()
                             : layer.positions * layer.outputs;
}

/// One feature of all rows, in groups of kTileColumns rows,
/// [group][feature][row], zero behind the end.
template <class F>
void pack_feature(
    Index rows, Index features, Index feature, double* packed, F&& value) {
  for (Index first = 0; first < rows; first += kTileColumns) {
    const Index some = std::min(kTileColumns, rows - first);
    double* to = packed + first * features + feature * kTileColumns;
    for (Index i = 0; i < some; ++i) to[i] = value(first + i);
    std::fill(to + some, to + kTileColumns, 0.0);
  }
}

/// Features of A at one position, `stride` samples apart.
template <class T>
void widen(const GramLayer<T>& layer,
           Index position,
           Index samples,
           Index stride,
           std::vector<double>& to) {
  grow(to, layer.inputs * stride);
  for (Index i = 0; i < layer.inputs; ++i) {
    const T* from = layer.a + (position * layer.a_step + i) * layer.a_stride;
    for (Index s = 0; s < stride; ++s)
      to[static_cast<std::size_t>(i * stride + s)] =
          s < samples ? static_cast<double>(from[s]) : 0.0;
  }
}

}  // namespace

/// Features of B from `first` on, and per pair of positions the factors
/// A_p^T A_q + 1.
template <class T>
void StructuredGram::pack(const GramLayer<T>& layer,
                          Index samples,
                          Index rows,
                          Index first) {
  for (Index p = 0; p < layer.positions; ++p)
    for (Index o = 0; o < layer.outputs; ++o) {
      const T* from = layer.b + (p * layer.b_step + o) * layer.b_stride;
      pack_feature(rows,
                   features_,
                   first + p * layer.outputs + o,
                   packed_.data(),
                   [=](Index r) { return static_cast<double>(from[r]); });
    }
  const Index stride = round_up(samples, kTileColumns);
  for (Index p = 0; p < layer.positions; ++p) {
    widen(layer, p, samples, stride, left_);
    for (Index q = 0; q < layer.positions; ++q) {
      widen(layer, q, samples, stride, right_);
      const Index size = samples * stride;
      const Index begin = static_cast<Index>(terms_.size()) * size;
      grow(factors_, begin + size);
      double* factor = at(factors_, begin);
      multiply<Into::set>(samples,
                          stride,
                          layer.inputs,
                          {left_.data(), 1, stride},
                          right_.data(),
                          stride,
                          factor,
                          stride);
      if (layer.bias)
        for (Index i = 0; i < size; ++i) factor[i] += 1;
      terms_.push_back({first + p * layer.outputs,
                        first + q * layer.outputs,
                        layer.outputs});
    }
  }
}

/// The layer's columns of J, with the factor 1.
template <class T>
void StructuredGram::pack_columns(const GramLayer<T>& layer,
                                  Index rows_per_sample,
                                  Index rows,
                                  Index first) {
  const Index samples = rows / rows_per_sample;
  for (Index o = 0; o < layer.outputs; ++o)
    for (Index i = 0; i < layer.columns() / layer.outputs; ++i) {
      const bool bias = i == layer.inputs;
      left_.assign(static_cast<std::size_t>(rows), 0.0);
      for (Index p = 0; p < layer.positions; ++p) {
        const T* a =
            bias ? nullptr : layer.a + (p * layer.a_step + i) * layer.a_stride;
        const T* b = layer.b + (p * layer.b_step + o) * layer.b_stride;
        for (Index s = 0; s < samples; ++s) {
          const double scale = bias ? 1.0 : static_cast<double>(a[s]);
          double* to = at(left_, s * rows_per_sample);
          const T* from = b + s * rows_per_sample;
          for (Index k = 0; k < rows_per_sample; ++k)
            to[k] = std::fma(scale, static_cast<double>(from[k]), to[k]);
        }
      }
      pack_feature(rows,
                   features_,
                   first + i * layer.outputs + o,
                   packed_.data(),
                   [&](Index r) { return *at(left_, r); });
    }
  const Index size = samples * round_up(samples, kTileColumns);
  const Index begin = static_cast<Index>(terms_.size()) * size;
  grow(factors_, begin + size);
  std::fill_n(at(factors_, begin), size, 1.0);
  terms_.push_back({first, first, layer.columns()});
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
  // As many layers at once as fit into the caches.
  bool first = true;
  while (!layers.empty()) {
    std::size_t count = 0;
    Index features = 0;
    for (; count < layers.size(); ++count) {
      features += packed_features(layers[count]);
      if (count > 0 && features > kMostFeatures) break;
    }
    add(layers.first(count), samples, rows_per_sample, first, gram, threads);
    layers = layers.subspan(count);
    first = false;
  }
}

std::size_t StructuredGram::bytes() const {
  std::size_t numbers =
      packed_.size() + left_.size() + right_.size() + factors_.size();
  for (const auto& e : expanded_) numbers += e.size();
  return numbers * sizeof(double);
}

template <class T>
void StructuredGram::add(std::span<const GramLayer<T>> layers,
                         Index samples,
                         Index rows_per_sample,
                         bool set,
                         BatchOut<double> gram,
                         Threads* threads) {
  const Index m = samples * rows_per_sample;
  features_ = 0;
  for (const auto& layer : layers) features_ += packed_features(layer);
  terms_.clear();
  grow(packed_, round_up(m, kTileColumns) * features_);
  Index packed = 0;
  for (const auto& layer : layers) {
    if (layer.written_out()) {
      pack_columns(layer, rows_per_sample, m, packed);
    } else {
      pack(layer, samples, m, packed);
    }
    packed += packed_features(layer);
  }
  const Index features = features_;
  const auto count = static_cast<Index>(terms_.size());
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
          const Term& term = terms_[static_cast<std::size_t>(l)];
          tile<kRows>(term.depth,
                      {row_pack + term.row * kTileColumns, 1, kTileColumns},
                      column_pack + term.column * kTileColumns,
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
            if (!set) {
              total[r][0] += load(out);
              total[r][1] += load(out + kWidth);
            }
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
            gram(i, r) = set ? row[i - c] : gram(i, r) + row[i - c];
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
