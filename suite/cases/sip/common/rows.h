/// Rows of profiles, as the paper's experiments write them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "suite/harness/registry.h"

namespace physinv {

/// Methods on the first seeds, each for so many updates or steps.
inline Row row(std::vector<std::string> methods,
               Index n,
               std::uint64_t seeds,
               Index updates = 0,
               Precision precision = Precision::f32) {
  return {.methods = std::move(methods),
          .n = {n},
          .seeds = first_seeds(seeds),
          .iterations = updates,
          .precision = precision};
}

inline std::vector<Row> joined(std::vector<Row> a, const std::vector<Row>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace physinv
