/// The rows of a triangle in parts of equal area: for products with a panel,
/// and for updates by one, so that rows stay with their thread.
#pragma once

#include <algorithm>
#include <cmath>

#include "suite/core/batch.h"

namespace physinv::linalg {

class PanelParts {
 public:
  static constexpr Index kSquare = 64;  ///< two uses of a block from the L1

  /// The number of parts depends on the rows alone, and with it the order of
  /// sums.
  explicit PanelParts(Index rows)
      : rows_(rows),
        squares_((rows + kSquare - 1) / kSquare),
        count_(std::clamp<Index>(squares_ / 4, 1, 8)) {}

  Index count() const { return count_; }
  /// First row of part p where each part is cut into `pieces`.
  Index begin(Index p, Index pieces = 1) const {
    const Index all = count_ * pieces;
    if (p == all) return rows_;
    const double left =
        std::sqrt(1 - static_cast<double>(p) / static_cast<double>(all));
    return static_cast<Index>(static_cast<double>(squares_) * (1 - left)) *
           kSquare;
  }

 private:
  Index rows_, squares_, count_;
};

}  // namespace physinv::linalg
