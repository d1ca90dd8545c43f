/// The middle of a convolution by modes (spectral.h), between the transform of
/// its inputs and that of its outputs: the modes of every output from those of
/// all inputs,
///
///   A[o](k, l) = sum_c V[c][o](k, l) Z[c](k, l)
///
/// over the first and last `modes` row frequencies k and the first `modes`
/// column frequencies l of the `period`. It works in place on the sums of sines
/// and cosines that PlaneModes makes and takes, with the weights of the inverse
/// transform in it.
///
/// Parameters: V of the first k, V of the last k, real before imaginary part,
/// [in][out][k][l] each. With fewer than 2 `modes` rows the last k are taken
/// from where both have them, and the first have no effect there.
#pragma once

#include <algorithm>
#include <vector>

#include "suite/core/blocks.h"
#include "suite/core/check.h"
#include "suite/core/workspace.h"
#include "suite/nn/gemm.h"
#include "suite/nn/plane_modes.h"

namespace physinv::nn {

template <class T>
class ModeProduct {
 public:
  /// grid: positions of the inputs. The period has at least 2 `modes` columns
  /// and `modes` rows.
  ModeProduct(Grid grid, Grid period, Index channels, Index modes)
      : period_(period),
        channels_(channels),
        modes_(modes),
        sums_(grid, period, largest_row() + 1, modes),
        frequencies_(static_cast<std::size_t>(row_count())) {
    const Index n = period.rows;
    SUITE_CHECK(modes <= n && 2 * modes <= period.columns,
                "a spectral layer's plane is too small for its modes");
    Index number = 0;
    const auto add_mode = [&](Index k, Index last, Index row) {
      const bool negative = 2 * k > n;
      frequencies_[static_cast<std::size_t>(negative ? n - k : k)].push_back(
          {negative ? -1 : 1, last, row, number++});
    };
    for (Index row = 0; row < modes; ++row) {
      if (row < n - modes) add_mode(row, 0, row);
      add_mode(n - modes + row, 1, row);
    }
  }

  const PlaneModes<T>& sums() const { return sums_; }
  /// Largest row frequency + 1.
  Index row_count() const { return largest_row() + 1; }
  /// Complex numbers of Z for one channel and sample.
  Index mode_count() const {
    Index count = 0;
    for (const auto& of_k : frequencies_)
      count += static_cast<Index>(of_k.size());
    return count * modes_;
  }
  Index parameter_count() const { return 4 * spectral_size(); }

  /// u <- sums of what V makes of the modes in u; z <- these.
  void apply(
      const T* parameters, Index samples, T* u, T* z, Workspace& all) const {
    const Index c = channels_, width = Rows<T>(nullptr, 1, samples).width;
    const Index block = c * width;
    for_blocks(all, row_count(), [&](Index k, Workspace& work) {
      const auto& modes = frequencies_[static_cast<std::size_t>(k)];
      T* const weights = work.take<T>(2 * c * c, modes_).data();
      T* const matrix = work.take<T>(4 * c * c, 1).data();
      T* const a = work.take<T>(2 * block, 1).data();
      const auto mode = [&](const Mode& m, Index l) {
        return z + (m.number * modes_ + l) * 2 * block;
      };
      for (const Mode& m : modes)
        for (Index l = 0; l < modes_; ++l)
          gather(u, k, m, l, block, mode(m, l));
      clear(k, block, u);
      for (const Mode& m : modes) {
        unpack(parameters, m, weights);
        for (Index l = 0; l < modes_; ++l) {
          real_matrix(weights, l, matrix);
          gemm<T>({.m = 2 * c,
                   .n = width,
                   .k = 2 * c,
                   .a = matrix,
                   .a_row = 1,
                   .a_k = 2 * c,
                   .b = mode(m, l),
                   .b_stride = width,
                   .c = a,
                   .c_stride = width});
          scatter(a, k, m, l, block, u);
        }
      }
    });
  }
  /// u <- cotangent of the modes, from that of what was made of them, if
  /// wanted; parameters_bar, unless null, must be zero.
  void pull(const T* parameters,
            const T* z,
            Index samples,
            T* u,
            T* parameters_bar,
            bool wants_u,
            Workspace& all) const {
    const Index c = channels_, width = Rows<T>(nullptr, 1, samples).width;
    const Index block = c * width;
    for_blocks(all, row_count(), [&](Index k, Workspace& work) {
      const auto& modes = frequencies_[static_cast<std::size_t>(k)];
      const Index count = modes_ * static_cast<Index>(modes.size());
      T* const a_bar = work.take<T>(2 * block, count).data();
      T* const weights = work.take<T>(2 * c * c, modes_).data();
      T* const matrix = work.take<T>(4 * c * c, 1).data();
      T* const z_bar = work.take<T>(2 * block, 1).data();
      T* next = a_bar;
      for (const Mode& m : modes)
        for (Index l = 0; l < modes_; ++l, next += 2 * block)
          gather(u, k, m, l, block, next);
      clear(k, block, u);
      next = a_bar;
      for (const Mode& m : modes) {
        if (parameters_bar != nullptr)
          pull_weights(z + m.number * modes_ * 2 * block,
                       next,
                       samples,
                       m,
                       parameters_bar,
                       work);
        if (wants_u) unpack(parameters, m, weights);
        for (Index l = 0; l < modes_ && wants_u; ++l) {
          real_matrix(weights, l, matrix);
          gemm<T>({.m = 2 * c,
                   .n = width,
                   .k = 2 * c,
                   .a = matrix,
                   .a_row = 2 * c,
                   .a_k = 1,
                   .b = next + l * 2 * block,
                   .b_stride = width,
                   .c = z_bar,
                   .c_stride = width});
          scatter(z_bar, k, m, l, block, u);
        }
        next += modes_ * 2 * block;
      }
    });
  }

 private:
  /// Row frequency `sign` k, whose weights are row `row` of tensors 2 `last`
  /// (real) and 2 `last` + 1. Its modes are the `number`-th on the tape.
  struct Mode {
    int sign;
    Index last, row, number;
  };

  Index largest_row() const { return std::min(modes_, period_.rows / 2); }
  static void add(const T* from, Index count, T* to) {
    for (Index i = 0; i < count; ++i) to[i] += from[i];
  }
  static void subtract(const T* from, Index count, T* to) {
    for (Index i = 0; i < count; ++i) to[i] -= from[i];
  }
  /// Sums of frequency k, all columns, <- 0.
  void clear(Index k, Index block, T* u) const {
    const Index step = sums_.pitch(block);
    for (Index g = 0; g < sums_.column_sums(); ++g) {
      T* const row = u + g * sums_.row_sums() * step;
      std::fill_n(row + sums_.cos_row(k) * step, block, T(0));
      if (k > 0) std::fill_n(row + sums_.sin_row(k) * step, block, T(0));
    }
  }

  Index mode_size() const { return modes_ * modes_; }
  Index spectral_size() const { return channels_ * channels_ * mode_size(); }
  /// Of the weights of all l, from the first input to the first output.
  Index place(const Mode& m, Index part) const {
    return (2 * m.last + part) * spectral_size() + m.row * modes_;
  }
  /// Modes of frequency (m.sign k, l) from the sums u, and the transpose.
  /// Z = (cos cos -+ sin sin) - i (+-cos sin + sin cos), columns before rows.
  void gather(
      const T* u, Index k, const Mode& m, Index l, Index block, T* z) const {
    const auto at = [&](Index g, Index h) {
      return u + (g * sums_.row_sums() + h) * sums_.pitch(block);
    };
    T *re = z, *im = z + block;
    std::copy_n(at(sums_.cos_column(l), sums_.cos_row(k)), block, re);
    std::fill_n(im, block, T(0));
    if (l > 0) subtract(at(sums_.sin_column(l), sums_.cos_row(k)), block, im);
    if (k == 0) return;
    const auto along = m.sign > 0 ? subtract : add;
    along(at(sums_.cos_column(l), sums_.sin_row(k)), block, im);
    if (l > 0) along(at(sums_.sin_column(l), sums_.sin_row(k)), block, re);
  }
  void scatter(
      const T* z, Index k, const Mode& m, Index l, Index block, T* u) const {
    const auto at = [&](Index g, Index h) {
      return u + (g * sums_.row_sums() + h) * sums_.pitch(block);
    };
    const T *re = z, *im = z + block;
    add(re, block, at(sums_.cos_column(l), sums_.cos_row(k)));
    if (l > 0) subtract(im, block, at(sums_.sin_column(l), sums_.cos_row(k)));
    if (k == 0) return;
    const auto along = m.sign > 0 ? subtract : add;
    along(im, block, at(sums_.cos_column(l), sums_.sin_row(k)));
    if (l > 0) along(re, block, at(sums_.sin_column(l), sums_.sin_row(k)));
  }
  /// V(k, .) as [real, imaginary][l][in][out].
  void unpack(const T* parameters, const Mode& m, T* weights) const {
    const Index c = channels_;
    for (const Index part : {0, 1})
      transpose(parameters + place(m, part),
                mode_size(),
                c * c,
                modes_,
                weights + part * modes_ * c * c,
                c * c);
  }
  /// [in re, in im][out re, out im]: the product with V(k, l) in real numbers,
  /// with the weight of the inverse transform.
  void real_matrix(const T* weights, Index l, T* matrix) const {
    const Index c = channels_;
    const T* re = weights + l * c * c;
    const T* im = re + modes_ * c * c;
    const T scale = static_cast<T>(inverse_weight(l));
    for (Index i = 0; i < c; ++i, re += c, im += c) {
      T* const of_re = matrix + i * 2 * c;
      T* const of_im = of_re + c * 2 * c;
      for (Index o = 0; o < c; ++o) {
        of_re[o] = of_im[c + o] = scale * re[o];
        of_re[c + o] = scale * im[o];
        of_im[o] = -of_re[c + o];
      }
    }
  }
  double inverse_weight(Index l) const {
    return (l == 0 ? 1.0 : 2.0) / static_cast<double>(period_.positions());
  }

  void pull_weights(const T* z,
                    const T* a_bar,
                    Index samples,
                    const Mode& m,
                    T* parameters_bar,
                    Workspace& work) const {
    const Index c = channels_, width = Rows<T>(nullptr, 1, samples).width;
    const Index across = round_up(2 * c, kNarrowLanes<T>);
    const Workspace::Scope scope(work);
    T* const a_t = work.take<T>(across, samples).data();
    T* const sums = work.take<T>(across, 2 * c).data();
    T* const weights_bar = work.take<T>(2 * c * c, modes_).data();
    for (Index l = 0; l < modes_; ++l) {
      transpose(a_bar + l * 2 * c * width, width, 2 * c, samples, a_t, across);
      gemm<T>({.m = 2 * c,
               .n = 2 * c,
               .k = samples,
               .a = z + l * 2 * c * width,
               .a_row = width,
               .a_k = 1,
               .b = a_t,
               .b_stride = across,
               .c = sums,
               .c_stride = across});
      const T scale = static_cast<T>(inverse_weight(l));
      T* re = weights_bar + l * c * c;
      T* im = re + modes_ * c * c;
      for (Index i = 0; i < c; ++i, re += c, im += c) {
        const T* of_re = sums + i * across;
        const T* of_im = of_re + c * across;
        for (Index o = 0; o < c; ++o) {
          re[o] = scale * (of_re[o] + of_im[c + o]);
          im[o] = scale * (of_re[c + o] - of_im[o]);
        }
      }
    }
    for (const Index part : {0, 1})
      transpose(weights_bar + part * modes_ * c * c,
                c * c,
                modes_,
                c * c,
                parameters_bar + place(m, part),
                mode_size());
  }
  Grid period_;
  Index channels_, modes_;
  PlaneModes<T> sums_;
  std::vector<std::vector<Mode>> frequencies_;  ///< by k
};

}  // namespace physinv::nn
