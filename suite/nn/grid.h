/// Extent of a field inside a network.
#pragma once

#include <cstdint>

#include "suite/core/batch.h"

namespace physinv::nn {

/// Positions are numbered row by row; one-dimensional fields have one row.
struct Grid {
  Index columns = 1, rows = 1;

  Index positions() const { return columns * rows; }
  bool flat() const { return rows == 1; }
};

enum class Padding : std::uint8_t {
  zero,
  circular,
  none,  ///< only where all taps are inside; one dimension
};

}  // namespace physinv::nn
