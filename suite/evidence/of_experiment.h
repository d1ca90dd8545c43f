/// A quantity of another experiment than the one that asks: tables of a study
/// whose settings are experiments of their own.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "suite/evidence/quantity.h"

namespace physinv {

/// As if `experiment` asked; runs that others are compared with are looked for
/// there, too.
inline Quantity of_experiment(const std::string& experiment,
                              const Quantity& q) {
  std::vector<Select> runs;
  for (const Select& s : q.runs())
    runs.push_back(s.experiment.empty() ? s.in(experiment) : s);
  return {[=](const Evidence& e) { return q(e.of(experiment)); },
          std::move(runs),
          q.printed()};
}

}  // namespace physinv
