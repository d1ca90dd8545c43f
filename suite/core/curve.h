/// What was seen while a stage ran: one column per measured point.
#pragma once

#include <vector>

#include "suite/core/batch.h"

namespace physinv {

/// Points are rows of the axes and columns of `loss` and `x`.
struct Curve {
  std::vector<double> iteration;    ///< iterations done, 0 = the start
  std::vector<double> seconds;      ///< solving time, clock stopped meanwhile
  std::vector<double> evaluations;  ///< simulations so far, all examples
  Batch<double> loss;  ///< examples x points: true loss of the estimate
  Batch<double> x;     ///< (unknowns * tracked examples) x points

  Index points() const { return static_cast<Index>(iteration.size()); }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(iteration, seconds, evaluations, loss, x);
  }
};

}  // namespace physinv
