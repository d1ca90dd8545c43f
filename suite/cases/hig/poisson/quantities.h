/// The singular values that updates of the Poisson experiment kept.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "suite/evidence/runs.h"

namespace physinv::hig::poisson {

inline constexpr const char* kName = "hig/poisson";

/// A method's updates by HIG or Gauss-Newton, over all seeds. A Cholesky
/// factorisation has no smallest value, only a lower bound.
struct Phase {
  std::string method;
  Index updates = 0, rows = 0, least_kept = 0, unproven = 0, runs = 0;
  double smallest = std::numeric_limits<double>::infinity();
};

/// Of every method whose records say how many singular values were kept.
std::vector<Phase> phases(const Evidence& e);

}  // namespace physinv::hig::poisson
