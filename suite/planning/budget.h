/// What to run first where time is short. Which cases run may follow the
/// clock; what a case computes never does.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "suite/harness/case.h"

namespace physinv {

/// Final median losses of cases that finished, by their index.
using Finished = std::map<std::size_t, double>;

/// Is the order of the methods on the same experiment and n still open? It is
/// with fewer than two seeds of a method, and where ranges of neighbours'
/// losses overlap.
bool undecided(const std::vector<std::vector<double>>& losses_by_method);

/// The order of a coarse pass, cheapest first: every method on the first seed,
/// all n; then, seed by seed, the cases whose ranking is undecided; the rest
/// last.
std::vector<std::size_t> budget_order(const std::vector<Case>& cases,
                                      std::vector<std::size_t> queue,
                                      const Finished& finished,
                                      const std::vector<double>& seconds);

}  // namespace physinv
