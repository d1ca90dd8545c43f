/// What the curve of a training stage says.
#pragma once

#include "suite/results/record.h"

namespace physinv {

/// One row of an array along the curve; what overflowed is infinite again, as
/// records hold finite numbers only.
struct CurveRow {
  const StageRecord& stage;
  const char* array = "mean_loss";
  Index row = 0;

  Index points() const { return stage.curve.points(); }
  double updates(Index k) const {
    return stage.curve.iteration[static_cast<std::size_t>(k)];
  }
  double operator()(Index k) const;
  double last() const { return (*this)(points() - 1); }
};

}  // namespace physinv
