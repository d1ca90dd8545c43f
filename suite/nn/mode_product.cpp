#include "suite/nn/mode_product.h"

#include <algorithm>

#include "suite/core/blocks.h"
#include "suite/core/check.h"
#include "suite/nn/gemm.h"

namespace physinv::nn {
namespace {

Index largest_row(Grid period, Index modes) {
  return std::min(modes, period.rows / 2);
}

template <class T>
void add(const T* from, Index count, T* to) {
  for (Index i = 0; i < count; ++i) to[i] += from[i];
}

template <class T>
void subtract(const T* from, Index count, T* to) {
  for (Index i = 0; i < count; ++i) to[i] -= from[i];
}

}  // namespace

template <class T>
ModeProduct<T>::ModeProduct(Grid grid, Grid period, Index channels, Index modes)
    : period_(period),
      channels_(channels),
      modes_(modes),
      sums_(grid, period, largest_row(period, modes) + 1, modes),
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

template <class T>
Index ModeProduct<T>::row_count() const {
  return largest_row(period_, modes_) + 1;
}

template <class T>
Index ModeProduct<T>::mode_count() const {
  Index count = 0;
  for (const auto& of_k : frequencies_)
    count += static_cast<Index>(of_k.size());
  return count * modes_;
}

template <class T>
double ModeProduct<T>::inverse_weight(Index l) const {
  return (l == 0 ? 1.0 : 2.0) / static_cast<double>(period_.positions());
}

/// Z = (cos cos -+ sin sin) - i (+-cos sin + sin cos), columns before rows.
template <class T>
void ModeProduct<T>::gather(
    const T* u, Index k, const Mode& m, Index l, Index block, T* z) const {
  const auto at = [&](Index g, Index h) {
    return u + (g * sums_.row_sums() + h) * sums_.pitch(block);
  };
  T *re = z, *im = z + block;
  std::copy_n(at(sums_.cos_column(l), sums_.cos_row(k)), block, re);
  std::fill_n(im, block, T(0));
  if (l > 0) subtract(at(sums_.sin_column(l), sums_.cos_row(k)), block, im);
  if (k == 0) return;
  const auto along = m.sign > 0 ? subtract<T> : add<T>;
  along(at(sums_.cos_column(l), sums_.sin_row(k)), block, im);
  if (l > 0) along(at(sums_.sin_column(l), sums_.sin_row(k)), block, re);
}

template <class T>
void ModeProduct<T>::scatter(
    const T* z, Index k, const Mode& m, Index l, Index block, T* u) const {
  const auto at = [&](Index g, Index h) {
    return u + (g * sums_.row_sums() + h) * sums_.pitch(block);
  };
  const T *re = z, *im = z + block;
  add(re, block, at(sums_.cos_column(l), sums_.cos_row(k)));
  if (l > 0) subtract(im, block, at(sums_.sin_column(l), sums_.cos_row(k)));
  if (k == 0) return;
  const auto along = m.sign > 0 ? subtract<T> : add<T>;
  along(im, block, at(sums_.cos_column(l), sums_.sin_row(k)));
  if (l > 0) along(re, block, at(sums_.sin_column(l), sums_.sin_row(k)));
}

template <class T>
void ModeProduct<T>::unpack(const T* parameters,
                            const Mode& m,
                            T* weights) const {
  const Index c = channels_;
  for (const Index part : {0, 1})
    transpose(parameters + place(m, part),
              mode_size(),
              c * c,
              modes_,
              weights + part * modes_ * c * c,
              c * c);
}

template <class T>
void ModeProduct<T>::real_matrix(const T* weights, Index l, T* matrix) const {
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

namespace {

/// Sums of frequency k, all columns, <- 0.
template <class T>
void clear(const PlaneModes<T>& modes, Index k, Index block, T* u) {
  for (Index g = 0; g < modes.column_sums(); ++g) {
    T* const row = u + g * modes.row_sums() * modes.pitch(block);
    std::fill_n(row + modes.cos_row(k) * modes.pitch(block), block, T(0));
    if (k > 0)
      std::fill_n(row + modes.sin_row(k) * modes.pitch(block), block, T(0));
  }
}

}  // namespace

template <class T>
void ModeProduct<T>::apply(
    const T* parameters, Index samples, T* u, T* z, Workspace& all) const {
  const Index c = channels_, width = Lanes<T>(nullptr, 1, samples).width;
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
      for (Index l = 0; l < modes_; ++l) gather(u, k, m, l, block, mode(m, l));
    clear(sums_, k, block, u);
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

template <class T>
void ModeProduct<T>::pull(const T* parameters,
                          const T* z,
                          Index samples,
                          T* u,
                          T* parameters_bar,
                          bool wants_u,
                          Workspace& all) const {
  const Index c = channels_, width = Lanes<T>(nullptr, 1, samples).width;
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
    clear(sums_, k, block, u);
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

template <class T>
void ModeProduct<T>::pull_weights(const T* z,
                                  const T* a_bar,
                                  Index samples,
                                  const Mode& m,
                                  T* parameters_bar,
                                  Workspace& work) const {
  const Index c = channels_, width = Lanes<T>(nullptr, 1, samples).width;
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

template class ModeProduct<float>;
template class ModeProduct<double>;

}  // namespace physinv::nn
