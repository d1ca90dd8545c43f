/// A stage's line as tests vary it.
#pragma once

#include <string>

#include "suite/gate/stage_line.h"

namespace physinv {

inline StageLine line(std::string name) {
  StageLine l{.name = std::move(name),
              .trajectory = "0123456789abcdef",
              .results = "fedcba9876543210",
              .stop = Stop::converged};
  l.statuses = {3, 1, 0, 0};
  l.losses = {.best = 1e-6, .median = 2e-4, .worst = 3e-2};
  l.digits = 4;
  l.work = {10, 44, 40, 0, 0, 0, 0};
  l.jitter = {0, 2, 0, 0, 0, 0, 0};
  l.fastest = 1.25, l.slowest = 1.5;
  return l;
}

}  // namespace physinv
