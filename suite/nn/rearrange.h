/// Into and out of the convolutional part's order of rows (see window.h).
#pragma once

#include "suite/nn/grid.h"
#include "suite/nn/piecewise_linear.h"

namespace physinv::nn {

/// Rows: `before` numbers, `channels` fields as [channel][position], `after`
/// numbers -> [position][before, channels, after]. A number z becomes a field
/// of constant value (z - shift) / unit. Of the fields, which have `columns`,
/// the first `hidden` are read as zero.
struct FieldInputOptions {
  Index positions = 1;
  Index before = 0, channels = 1, after = 0;
  double shift = 0, unit = 1;
  Index columns = 1, hidden = 0;

  Index inputs() const { return before + channels * positions + after; }
  Index width() const { return before + channels + after; }
};

template <class T>
class FieldInput final : public PiecewiseLinear<T> {
 public:
  explicit FieldInput(const FieldInputOptions& options);

  void forward(const LayerArgs<T>& at,
               Lanes<const T> x,
               Lanes<T> y) const override;
  void backward(const LayerArgs<T>& at, const Backward<T>& b) const override;
  void tangent(const LayerArgs<T>& at, const Tangent<T>& t) const override;

 private:
  FieldInputOptions o_;
};

/// One channel -> [position](value, row, column), the coordinates from 0 to 1
/// over the grid.
template <class T>
class Coordinates final : public Layer<T> {
 public:
  explicit Coordinates(Grid grid)
      : Layer<T>(grid.positions(), 3 * grid.positions()), grid_(grid) {}

  void forward(const LayerArgs<T>& at,
               Lanes<const T> x,
               Lanes<T> y) const override;
  void backward(const LayerArgs<T>& at, const Backward<T>& b) const override;
  void tangent(const LayerArgs<T>& at, const Tangent<T>& t) const override;
  void backward_tangent(const LayerArgs<T>& at,
                        const BackwardTangent<T>& b) const override;

 private:
  Grid grid_;
};

/// [position][channel] -> [channel][position], without the first `hidden` of
/// the grid's columns.
template <class T>
class Flatten final : public PiecewiseLinear<T> {
 public:
  Flatten(Index positions, Index channels, Index columns = 1, Index hidden = 0)
      : PiecewiseLinear<T>(positions * channels,
                           positions / columns * (columns - hidden) * channels),
        positions_(positions),
        channels_(channels),
        columns_(columns),
        hidden_(hidden) {}

  void forward(const LayerArgs<T>& at,
               Lanes<const T> x,
               Lanes<T> y) const override;
  void backward(const LayerArgs<T>& at, const Backward<T>& b) const override;

 private:
  /// f(position, place among those that are left).
  template <class F>
  void each_left(F&& f) const {
    Index left = 0;
    for (Index p = 0; p < positions_; ++p)
      if (p % columns_ >= hidden_) f(p, left++);
  }
  Index left() const { return this->outputs() / channels_; }

  Index positions_, channels_, columns_, hidden_;
};

extern template class FieldInput<float>;
extern template class FieldInput<double>;
extern template class Coordinates<float>;
extern template class Coordinates<double>;
extern template class Flatten<float>;
extern template class Flatten<double>;

}  // namespace physinv::nn
