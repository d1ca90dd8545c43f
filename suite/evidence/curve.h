/// What the curve of a training stage says, at its measured points and between
/// them.
#pragma once

#include <optional>

#include "suite/store/record.h"

namespace physinv {

inline constexpr ArrayKey kMeanLoss{"mean_loss"};

/// One row of an array along the curve; what overflowed is infinite again, as
/// records hold finite numbers only.
struct CurveRow {
  const StageRecord& stage;
  ArrayKey array = kMeanLoss;
  Index row = 0;

  Index points() const { return stage.curve.points(); }
  double updates(Index k) const {
    return stage.curve.iteration[static_cast<std::size_t>(k)];
  }
  double operator()(Index k) const;
  double last() const { return (*this)(points() - 1); }
};

/// The last measured point at or before `updates`. Empty if the run is shorter.
std::optional<Index> last_point(const StageRecord& stage, Index updates);

/// A point of the mean test loss, perhaps between two that were measured: there
/// the logarithm of the loss is linear.
struct LossPoint {
  double updates = 0, seconds = 0, loss = 0;
};

LossPoint loss_point(const StageRecord& stage, Index k);

/// After so many updates; a run that diverged counts as infinite from there on.
/// Empty if the stage is not there or is shorter.
std::optional<LossPoint> level_at(const StageRecord* stage, double updates);
std::optional<double> loss_at(const StageRecord& stage, double updates);

/// After so many seconds of the stage. Empty if it is shorter.
std::optional<LossPoint> level_after(const StageRecord& stage, double seconds);

/// Where the loss first falls to `loss`. Empty if it does not.
std::optional<LossPoint> reaches(const StageRecord* stage, double loss);

}  // namespace physinv
