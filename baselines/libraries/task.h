/// What an experiment asks of the solvers of all libraries.
#pragma once

#include <vector>

#include "suite/core/options.h"

namespace libraries {

using physinv::Index;

struct Task {
  Index iterations = 1000;
  Index evaluations = 100000;  ///< of a problem at most
  Index throws_at = 0;         ///< the evaluation that throws; 0: none does
  /// Bounds of the unknowns, for solvers that take some; empty: none.
  std::vector<double> lower = {}, upper = {};

  auto fields() const {
    return std::tuple{
        physinv::implied(iterations),
        physinv::field("evaluations", evaluations),
        physinv::if_changed(physinv::field("throws_at", throws_at)),
        physinv::if_changed(physinv::field("lower", lower)),
        physinv::if_changed(physinv::field("upper", upper))};
  }
};

}  // namespace libraries
