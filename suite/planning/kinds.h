/// Chains of stages as they are tried: what `predict` and `forecast` share.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "suite/harness/case.h"
#include "suite/planning/predict.h"
#include "suite/planning/trials.h"

namespace physinv {

/// Of a worker before it does anything: code, libraries, registry, and what
/// the allocator keeps.
inline constexpr double kProgramMemory = 32e6;  // bytes

/// Experiment, method, precision and iterations: chains that differ in n and
/// seed alone.
using Kind =
    std::tuple<std::string, std::string, Precision, std::vector<Index>>;
Kind kind_of(const Case& c);

struct Sizes {
  const Case* smallest = nullptr;
  const Case* largest = nullptr;
};
using Kinds = std::map<Kind, Sizes>;
Kinds kinds_of(const std::vector<Case>& cases);

/// Declared work of a whole chain: the same for every seed, and its problems
/// and networks are made for it.
class Operations {
 public:
  double operator()(const Case& c) {
    const auto [at, is_new] =
        known_.try_emplace({c.method, c.info.n, c.stage_iterations});
    if (is_new) at->second = c.operations();
    return at->second;
  }

 private:
  std::map<std::tuple<const Method*, Index, std::vector<Index>>, double> known_;
};

/// The trials of a kind, from few samples to many; what is not known runs.
std::vector<Trial> trials_of(const Sizes& s, Trials& trials);
/// Of these, those that are known; nothing runs.
std::vector<Trial> known_trials(const Sizes& s, const Trials& trials);

/// Of a case by its kind's trials.
Cost cost_of(const Case& c, const std::vector<Trial>& all);
/// The same without a trial: memory and disk of what every case has, and no
/// time.
Cost unmeasured_cost(const Case& c);

}  // namespace physinv
