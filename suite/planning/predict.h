/// What cases will cost, from their counted operations and the speeds of this
/// machine.
#pragma once

#include <functional>
#include <vector>

namespace physinv {

class Trials;
struct Case;

struct Cost {
  /// Of one thread of an idle core, without bookkeeping; NaN: not known.
  double seconds = 0;
  double least = 0, most = 0;  ///< between which the seconds are expected
  double memory = 0;           ///< peak bytes of a worker process
  double disk = 0;             ///< bytes
  std::vector<double> stage_seconds;
};

/// In the order of the cases. A chain is tried with the smallest and the
/// largest n of the selection; between the two, time and memory follow a power
/// of n. `say` is called for each trial that has to run.
std::vector<Cost> predict(const std::vector<Case>& cases,
                          Trials& trials,
                          const std::function<void(const Case&)>& say = {});

}  // namespace physinv
