/// Training at a rate that a small search finds, for comparisons that owe every
/// rule the same care.
///
/// Each of the rates trains the network from its start for a share of the
/// stage's updates, on the search's own training data and problems, drawn from
/// a separate stream that no result is measured on. The rate with the lowest
/// mean loss at the end wins; one that diverges loses to all that do not, the
/// smaller of equals wins. Then the stage is `train` at that rate, to the bit.
///
/// The search counts as set-up: its time is on the record's set-up clock, its
/// calls of the physics are not counted.
///
/// Arrays left in addition to those of `train`: `searched_rates` and
/// `searched_loss` (1 x rates; what is not finite is 1e300), `rate` (1).
#pragma once

#include <memory>
#include <vector>

#include "optimizers/training.h"

namespace physinv {

struct RateSearch {
  std::vector<double> rates;  ///< ascending
  double share = 0.25;        ///< of the updates, for each
  Index problems = 64;        ///< whose loss decides
};

std::shared_ptr<const Stage> train_at_best_rate(const TrainingOptions& options,
                                                const RateSearch& search);

}  // namespace physinv
