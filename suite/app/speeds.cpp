#include "suite/app/speeds.h"

#include <fmt/format.h>

#include <cstdio>

#include "suite/app/installed.h"
#include "suite/harness/errors.h"
#include "suite/planning/forecast.h"

namespace physinv {

Trials known_speeds() {
  Trials trials;
  if (!trials.warning().empty()) fmt::print(stderr, "{}\n", trials.warning());
  return trials;
}

std::filesystem::path durations_file() {
  try {
    return published_directory() / "durations.csv";
  } catch (const UsageError&) {  // no published numbers here
    return {};
  }
}

std::vector<Cost> costs_without_runs(const std::vector<Case>& cases) {
  const auto published = Durations::read(durations_file());
  auto costs = forecast(cases, published, known_speeds(), machine_factor());
  add_memory(costs, cases, published);
  return costs;
}

}  // namespace physinv
