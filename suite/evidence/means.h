/// Means of numbers of several experiments, and how far one differs from
/// another on the same seeds.
#pragma once

#include <vector>

#include "suite/evidence/quantity.h"

namespace physinv {

/// The mean of one number of each experiment; missing if one is. Its spread is
/// that of one of as many seeds as the fewest have, with the error that all
/// together leave.
Quantity mean_of_all(const std::vector<Quantity>& all);

/// Of the differences that `a` has from `b` on the same seed: their mean over
/// its standard error.
Quantity growth_in_errors(const Select& a,
                          const Select& b,
                          const RunValue& value);

}  // namespace physinv
