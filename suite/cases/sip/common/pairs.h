/// Runs of two methods from the same seed, which share data and start.
#pragma once

#include <optional>
#include <utility>

#include "suite/evidence/quantity.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training.h"
#include "suite/results/record.h"

namespace physinv {

/// Of runs that diverged: whatever they had reached.
inline RunValue or_infinite(RunValue value) {
  return [value = std::move(value)](const Run& run) {
    return run.stage->stop == Stop::diverged ? std::optional(kInfinite)
                                             : value(run);
  };
}

/// The largest of a over b.
inline Quantity worst_ratio(const Select& a,
                            const Select& b,
                            const RunValue& value) {
  return also_asks(highest(a, over(value, beside(b, value))), {b});
}

}  // namespace physinv
