/// Derivatives of what channel_norm.h computes, along a direction in which x
/// moves by x_dot, scales and offsets by parameters_dot. With
/// n = (x - mean) inverse, the statistics' derivatives are
///
///   mean' = mean of x_dot,  inverse' = -inverse^2 slope,  slope = mean of
///   n x_dot,  n' = inverse (x_dot - mean' - n slope)
///
/// over the batch and its positions, and zero outside training.
#pragma once

#include "suite/nn/channel_norm.h"

namespace physinv::nn {

/// Per-channel derivatives, as the columns of a slot: channels each.
template <class T>
struct NormDots {
  T *mean = nullptr, *slope = nullptr;
  static constexpr Index kCount = 2;
  NormDots(T* p, Index channels) : mean(p), slope(p + channels) {}
};

/// All that both passes read.
template <class T>
struct NormTangent : NormPass<T> {
  NormDots<T> dots;
  const T* parameters_dot;
  Rows<const T> x_dot;
};

/// y_dot at output positions [begin, end).
template <class T>
void normalise_tangent(const NormTangent<T>& of,
                       Rows<T> y_dot,
                       Index begin,
                       Index end);

/// The cotangent of u and its derivative at the input positions of output
/// positions [begin, end): y_bar opened by activation and pooling. Padding
/// lanes become zero.
template <class T>
void open_cells(const NormTangent<T>& of,
                Rows<const T> y_dot,
                Rows<const T> y_bar,
                Rows<const T> y_bar_dot,
                Rows<T> u_bar,
                Rows<T> u_bar_dot,
                Index begin,
                Index end);

/// Means over samples and positions of u_bar, of u_bar n, and their
/// derivatives: channels each.
template <class T>
struct NormMeans {
  const T *sum, *product, *sum_dot, *product_dot;
};

/// u_bar and u_bar_dot at input positions [begin, end) become those of x.
template <class T>
void pull_norm_tangent(const NormTangent<T>& of,
                       const NormMeans<T>& means,
                       Rows<T> bar,
                       Rows<T> bar_dot,
                       Index begin,
                       Index end);

}  // namespace physinv::nn
