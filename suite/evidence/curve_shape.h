/// What the shape of a run's loss curve says: how steep, how even, how long on
/// one level.
#pragma once

#include <functional>
#include <vector>

#include "suite/evidence/quantity.h"
#include "suite/evidence/training.h"

namespace physinv {

/// How many octaves the loss falls while the updates double: at the end of the
/// run, or `before` doublings earlier.
RunValue steepness(int before = 0);
/// Fall of log(loss) between two times.
RunValue log_fall(const Clock& clock, double from, double to);
/// The longest stretch with a loss in [lowest, highest].
RunValue plateau(const Clock& clock, double lowest, double highest);
/// Mean |log| of what a point of the last half is over the one before it;
/// infinite if the run diverged.
RunValue scatter();
/// Median of the last three points.
RunValue settled_loss();

/// Share of the updates after which a run is below all the others of its seed;
/// the median.
Quantity lead(const Select& select, const std::vector<Select>& others);
/// Of one seed's values by several methods the largest over the smallest; the
/// median.
Quantity spread_of_seeds(const std::vector<Select>& of, const RunValue& value);
/// The largest of a quantity after so many updates, at the points of a curve
/// from `first` on.
Quantity highest_along(const Select& curve,
                       double first,
                       std::function<Quantity(double updates)> of);

/// What four seeds of five (two of three) stay above, or below.
Quantity most_stay_above(const Select& select, const RunValue& value);
Quantity most_stay_below(const Select& select, const RunValue& value);

}  // namespace physinv
