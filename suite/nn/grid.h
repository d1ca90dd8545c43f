/// Extent of a field inside a network.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "suite/core/batch.h"
#include "suite/core/options.h"

namespace physinv::nn {

/// Positions are numbered row by row; one-dimensional fields have one row.
struct Grid {
  Index columns = 1, rows = 1;

  Index positions() const { return columns * rows; }
  bool flat() const { return rows == 1; }
  auto fields() const {
    return std::tuple{field("columns", columns), field("rows", rows)};
  }
  /// "64x64"
  std::string text() const { return text_of(std::array{columns, rows}, "x"); }
};

enum class Padding : std::uint8_t {
  zero,
  circular,
  none,  ///< only where all taps are inside; one dimension
};

constexpr std::string_view to_string(Padding padding) {
  constexpr std::string_view kNames[] = {"zero", "circular", "none"};
  return kNames[static_cast<std::size_t>(padding)];
}

}  // namespace physinv::nn
