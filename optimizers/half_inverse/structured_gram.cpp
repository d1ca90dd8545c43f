#include "optimizers/half_inverse/structured_gram.h"

#include <algorithm>
#include <cmath>

#include "suite/core/check.h"
#include "suite/linalg/tile_product.h"

namespace physinv::hig {

using namespace linalg;
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

/// Whether a convolution's own columns are cheaper than pairs of positions.
template <class T>
bool written_out(const LayerRows<T>& layer) {
  const Index pairs = layer.positions * layer.positions * layer.outputs;
  return layer.positions > 1 && layer.columns() <= pairs;
}

template <class T>
Index packed_features(const LayerRows<T>& layer) {
  return written_out(layer) ? layer.columns() : layer.positions * layer.outputs;
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
void widen(const LayerRows<T>& layer,
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
void StructuredGram::pack(const LayerRows<T>& layer,
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
      for (Index i = 0; i < size; ++i) factor[i] += 1;
      terms_.push_back({first + p * layer.outputs,
                        first + q * layer.outputs,
                        layer.outputs});
    }
  }
}

/// The layer's columns of J, with the factor 1.
template <class T>
void StructuredGram::pack_columns(const LayerRows<T>& layer,
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
void StructuredGram::operator()(std::span<const LayerRows<T>> layers,
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

/// Blocks of G from what is packed: memory row r of G (its column r) from
/// c = r on.
class StructuredGram::Sweep {
 public:
  Sweep(StructuredGram& of,
        Index samples,
        Index rows_per_sample,
        bool set,
        BatchOut<double>& gram,
        Threads* threads)
      : of_(of),
        samples_(samples),
        per_(rows_per_sample),
        m_(samples * rows_per_sample),
        count_(static_cast<Index>(of.terms_.size())),
        stride_(round_up(samples, kTileColumns)),
        set_(set),
        gram_(gram) {
    of_.expanded_.resize(
        static_cast<std::size_t>(threads == nullptr ? 1 : threads->count()));
    for (auto& e : of_.expanded_) grow(e, kRows * count_ * kBlock);
  }

  /// The largest blocks first.
  void run(Threads* threads) const {
    const Index blocks = (m_ + kBlock - 1) / kBlock;
    for_blocks(threads, blocks, [&](Index reversed, int thread) {
      block((blocks - 1 - reversed) * kBlock,
            of_.expanded_[static_cast<std::size_t>(thread)].data());
    });
  }

 private:
  using Tile = Pack8[kRows][2];

  void block(Index begin, double* expanded) const {
    const Index end = std::min(begin + kBlock, m_);
    Index from = -1, to = -1;  // samples whose factors are in `expanded`
    for (Index r0 = 0; r0 < end; r0 += kRows) {
      const Index first = r0 / per_, last = std::min(r0 + kRows, m_) - 1;
      if (first != from || last / per_ > to) {
        from = first, to = last / per_;
        expand(from, to, begin, expanded);
      }
      const double* of_row[kRows];
      for (Index r = 0; r < kRows; ++r)
        of_row[r] =
            expanded + (std::min(r0 + r, last) / per_ - from) * count_ * kBlock;
      Index c = std::max(begin, r0 / kTileColumns * kTileColumns);
      for (; c < end; c += kTileColumns) {
        Tile total = {};
        sum(r0, c, c - begin, of_row, total);
        if (c >= r0 + kRows - 1 && c + kTileColumns <= m_) {
          put(r0, c, total);
        } else {
          put_part(r0, last, c, total);
        }
      }
    }
  }

  /// Factors of samples from..to with those of the rows of a block.
  void expand(Index from, Index to, Index begin, double* expanded) const {
    for (Index s = from; s <= to; ++s)
      for (Index l = 0; l < count_; ++l) {
        const double* factor = at(of_.factors_, (l * samples_ + s) * stride_);
        double* e = expanded + ((s - from) * count_ + l) * kBlock;
        Index other = begin / per_, k = begin % per_;
        for (Index c = 0; c < kBlock; ++c) {
          e[c] = begin + c < m_ ? factor[other] : 0.0;
          if (++k == per_) k = 0, ++other;
        }
      }
  }

  [[gnu::always_inline]] void sum(Index r0,
                                  Index c,
                                  Index in_block,
                                  const double* const* of_row,
                                  Tile& total) const {
    const Index features = of_.features_;
    const double* const row_pack =
        at(of_.packed_, r0 / kTileColumns * features * kTileColumns) +
        r0 % kTileColumns;
    const double* const column_pack = at(of_.packed_, c * features);
    for (Index l = 0; l < count_; ++l) {
      const Term& term = of_.terms_[static_cast<std::size_t>(l)];
      tile_rows(kRows,
                term.depth,
                {row_pack + term.row * kTileColumns, 1, kTileColumns},
                column_pack + term.column * kTileColumns,
                kTileColumns,
                [&](Index r, Pack8 x, Pack8 y) {
                  const double* e = of_row[r] + l * kBlock + in_block;
                  total[r][0] = fma_lanes(x, load(e), total[r][0]);
                  total[r][1] = fma_lanes(y, load(e + kWidth), total[r][1]);
                });
    }
  }

  [[gnu::always_inline]] void put(Index r0, Index c, Tile& total) const {
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r) {
      double* out = &gram_(c, r0 + r);
      if (!set_) {
        total[r][0] += load(out);
        total[r][1] += load(out + kWidth);
      }
      store(out, total[r][0]);
      store(out + kWidth, total[r][1]);
    }
  }

  /// Of a tile across the diagonal, or beyond the end.
  void put_part(Index r0, Index last, Index c, const Tile& total) const {
    for (Index r = r0; r <= last; ++r) {
      double row[kTileColumns];
      store(row, total[r - r0][0]);
      store(row + kWidth, total[r - r0][1]);
      for (Index i = std::max(c, r); i < std::min(c + kTileColumns, m_); ++i)
        gram_(i, r) = set_ ? row[i - c] : gram_(i, r) + row[i - c];
    }
  }

  StructuredGram& of_;
  Index samples_, per_, m_, count_, stride_;
  bool set_;
  BatchOut<double>& gram_;
};

template <class T>
void StructuredGram::pack_all(std::span<const LayerRows<T>> layers,
                              Index samples,
                              Index rows_per_sample) {
  const Index m = samples * rows_per_sample;
  features_ = 0;
  for (const auto& layer : layers) features_ += packed_features(layer);
  terms_.clear();
  grow(packed_, round_up(m, kTileColumns) * features_);
  Index packed = 0;
  for (const auto& layer : layers) {
    if (written_out(layer)) {
      pack_columns(layer, rows_per_sample, m, packed);
    } else {
      pack(layer, samples, m, packed);
    }
    packed += packed_features(layer);
  }
}

template <class T>
void StructuredGram::add(std::span<const LayerRows<T>> layers,
                         Index samples,
                         Index rows_per_sample,
                         bool set,
                         BatchOut<double> gram,
                         Threads* threads) {
  pack_all(layers, samples, rows_per_sample);
  Sweep(*this, samples, rows_per_sample, set, gram, threads).run(threads);
}

template void StructuredGram::operator()<float>(
    std::span<const LayerRows<float>>,
    Index,
    Index,
    BatchOut<double>,
    Threads*);
template void StructuredGram::operator()<double>(
    std::span<const LayerRows<double>>,
    Index,
    Index,
    BatchOut<double>,
    Threads*);

}  // namespace physinv::hig
