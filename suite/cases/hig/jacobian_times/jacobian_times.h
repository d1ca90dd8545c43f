/// Where Jacobian durations (Tables 3 to 5) are measured.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "suite/core/batch.h"

namespace physinv::hig::jacobian_times {

/// Of an experiment of the paper.
inline std::string name_of(const std::string& experiment) {
  return experiment + "-jacobians";
}

/// The columns of an optimizer in a table.
struct Batches {
  const char *optimizer, *title, *takes;
  std::vector<Index> sizes;

  /// "gradient-b256", "jacobians-b32"
  std::string method(Index batch) const {
    return takes + ("-b" + std::to_string(batch));
  }
};
inline Batches of_adam(std::vector<Index> sizes) {
  return {"adam", "Adam", "gradient", std::move(sizes)};
}
inline Batches of_hig(std::vector<Index> sizes) {
  return {"hig", "HIG", "jacobians", std::move(sizes)};
}

struct Timed {
  const char *experiment, *table, *key;
  Batches adam, hig;
  Index updates;
};
inline const std::vector<Timed> kTimed = {
    {"hig/oscillators",
     "Table 3",
     "table3",
     of_adam({256, 512, 1024}),
     of_hig({32, 64, 128}),
     200},
    {"hig/poisson", "Table 4", "table4", of_adam({64}), of_hig({64}), 200},
    {"hig/quantum-dipole",
     "Table 5",
     "table5",
     of_adam({256, 512, 1024}),
     of_hig({8, 16}),
     10}};

}  // namespace physinv::hig::jacobian_times
