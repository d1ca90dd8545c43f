#include "suite/nn/plane_modes.h"

#include <numbers>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/nn/gemm.h"

namespace physinv::nn {
namespace {

/// Cosines of frequencies 0 .. count-1, then sines of 1 .. count-1.
template <class T>
std::vector<T> waves(Index count, Index period, Index extent) {
  std::vector<T> all;
  const auto angle = [&](Index k, Index i) {
    return 2 * std::numbers::pi * double(k * i % period) / double(period);
  };
  for (Index k = 0; k < count; ++k)
    for (Index i = 0; i < extent; ++i)
      all.push_back(static_cast<T>(math::cos(angle(k, i))));
  for (Index k = 1; k < count; ++k)
    for (Index i = 0; i < extent; ++i)
      all.push_back(static_cast<T>(math::sin(angle(k, i))));
  return all;
}

}  // namespace

template <class T>
PlaneModes<T>::PlaneModes(Grid grid,
                          Grid period,
                          Index row_count,
                          Index column_count)
    : grid_(grid),
      row_count_(row_count),
      column_count_(column_count),
      rows_(waves<T>(row_count, period.rows, grid.rows)),
      columns_(waves<T>(column_count, period.columns, grid.columns)) {
  SUITE_CHECK(grid.rows <= period.rows && grid.columns <= period.columns,
              "a field does not fit into its period");
}

template <class T>
void PlaneModes<T>::analyse_row(const T* x, Index r, Index block, T* t) const {
  const Index step = pitch(block);
  gemm<T>({.m = column_sums(),
           .n = block,
           .k = grid_.columns,
           .a = columns_.data(),
           .a_row = grid_.columns,
           .a_k = 1,
           .b = x,
           .b_stride = step,
           .c = t + r * step,
           .c_stride = grid_.rows * step});
}

template <class T>
void PlaneModes<T>::analyse_rows(const T* t, Index g, Index block, T* u) const {
  const Index step = pitch(block);
  gemm<T>({.m = row_sums(),
           .n = block,
           .k = grid_.rows,
           .a = rows_.data(),
           .a_row = grid_.rows,
           .a_k = 1,
           .b = t + g * grid_.rows * step,
           .b_stride = step,
           .c = u + g * row_sums() * step,
           .c_stride = step});
}

template <class T>
void PlaneModes<T>::synthesise_rows(const T* u,
                                    Index g,
                                    Index block,
                                    T* t) const {
  const Index step = pitch(block);
  gemm<T>({.m = grid_.rows,
           .n = block,
           .k = row_sums(),
           .a = rows_.data(),
           .a_row = 1,
           .a_k = grid_.rows,
           .b = u + g * row_sums() * step,
           .b_stride = step,
           .c = t + g * grid_.rows * step,
           .c_stride = step});
}

template <class T>
void PlaneModes<T>::synthesise_row(const T* t,
                                   Index r,
                                   Index block,
                                   T* x) const {
  const Index step = pitch(block);
  gemm<T>({.m = grid_.columns,
           .n = block,
           .k = column_sums(),
           .a = columns_.data(),
           .a_row = 1,
           .a_k = grid_.columns,
           .b = t + r * step,
           .b_stride = grid_.rows * step,
           .c = x,
           .c_stride = step});
}

template class PlaneModes<float>;
template class PlaneModes<double>;

}  // namespace physinv::nn
