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
LayerPointer<T> field_input(const FieldInputOptions& options);

/// One channel -> [position](value, row, column), the coordinates from 0 to 1
/// over the grid.
template <class T>
LayerPointer<T> coordinates(Grid grid);

/// [position][channel] -> [channel][position], without the first `hidden` of
/// the grid's columns.
template <class T>
LayerPointer<T> flatten(Index positions,
                        Index channels,
                        Index columns = 1,
                        Index hidden = 0);

}  // namespace physinv::nn
