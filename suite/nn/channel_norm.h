/// Batch normalisation over samples and positions, per channel, with what
/// follows it: an activation and max pooling by 2. Functions on rows laid out
/// position by position (see window.h), one block of positions at a time.
///
///   u = scale (x - mean) / sqrt(variance + 1e-5) + offset,  y = max f(u)
///
/// over the 1, 2 or 4 positions of a pooling cell; f must not decrease.
#pragma once

#include "suite/nn/grid.h"
#include "suite/nn/layer.h"

namespace physinv::nn {

struct NormShape {
  Grid grid;  ///< before pooling
  Index channels = 1;
  Activation activation = Activation::identity;
  bool pool = false;

  Index positions() const { return grid.positions(); }
  Grid pooled() const;
};

/// Half the extent along every axis that has one, rounded down.
Grid halved(Grid grid);

/// Per-channel constants, as the columns of a tape slot: channels each.
template <class T>
struct NormColumns {
  T *mean = nullptr, *inverse = nullptr, *unbiased = nullptr;
  static constexpr Index kCount = 3;
  NormColumns(T* p, Index channels)
      : mean(p), inverse(p + channels), unbiased(p + 2 * channels) {}
};

/// Mean and sum of squared deviations per channel of positions [begin, end):
/// moments = channels means, then channels sums.
template <class T>
void block_moments(
    Rows<const T> x, Index channels, Index begin, Index end, T* moments);

/// Puts the moments of blocks of `per_block` positions together, in order and
/// in double.
template <class T>
void combine_moments(const T* moments,
                     Index channels,
                     Index positions,
                     Index per_block,
                     Index samples,
                     NormColumns<T> to);

/// Running statistics instead.
template <class T>
void use_state(const T* state, Index channels, NormColumns<T> to);

/// Moves the running statistics (means, then variances) a tenth of the way.
template <class T>
void move_state(NormColumns<T> batch, Index channels, T* state);

/// What the passes over normalised channels read.
template <class T>
struct NormPass {
  NormShape shape;
  NormColumns<T> at;
  const T* parameters;  ///< scales, then offsets
  Rows<const T> x, y;
};

/// y at output positions [begin, end).
template <class T>
void normalise(NormPass<T> of, Rows<T> y, Index begin, Index end);

/// The cotangent's sums over output positions [begin, end): sums = channels
/// times sum of u_bar, then channels times sum of u_bar (x - mean) inverse.
template <class T>
void block_sums(
    NormPass<T> of, Rows<const T> y_bar, Index begin, Index end, T* sums);

/// totals = sum over blocks, in order and in double; divided by `count`.
template <class T>
void combine_sums(const T* sums, Index blocks, Index channels, T* totals);

/// x_bar at the input positions of output positions [begin, end), given the
/// sums' means over all samples and positions (zero outside training). Padding
/// lanes become zero.
template <class T>
void pull_norm(NormPass<T> of,
               const T* means,
               Rows<const T> y_bar,
               Rows<T> x_bar,
               Index begin,
               Index end);

}  // namespace physinv::nn
