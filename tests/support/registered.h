/// What is registered, as parameters of tests, and its cases cut to size.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "suite/harness/registry.h"
#include "suite/harness/run_case.h"

namespace physinv {
/// What GoogleTest shows of one, instead of its bytes.
inline void PrintTo(const Case& c, std::ostream* out) { *out << c.info.name; }
inline void PrintTo(const std::shared_ptr<const Experiment>& e,
                    std::ostream* out) {
  *out << e->name;
}
}  // namespace physinv

namespace physinv::test {

using ExperimentPtr = std::shared_ptr<const Experiment>;

inline std::string test_name(std::string name) {
  std::replace_if(
      name.begin(),
      name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0; },
      '_');
  return name;
}

struct ExperimentName {
  std::string operator()(
      const testing::TestParamInfo<ExperimentPtr>& info) const {
    return test_name(info.param->name);
  }
};

/// One case of `method`, every stage with that many iterations.
inline Case small_case(ExperimentPtr experiment,
                       const std::string& method,
                       Index n,
                       Index iterations,
                       Precision precision = Precision::f32) {
  Case c;
  c.experiment = std::move(experiment);
  c.method = find_method(*c.experiment, method);
  if (c.method == nullptr) throw std::runtime_error("no method " + method);
  c.info = {.name = c.experiment->name + "/" + method,
            .experiment = c.experiment->name,
            .method = method,
            .profile = "test",
            .n = n,
            .seed = 1,
            .precision = precision};
  for (const auto& stage : c.method->chain)
    c.info.stages.push_back(stage->name());
  c.stage_iterations.assign(c.method->chain.size(), iterations);
  return c;
}

inline std::vector<StageRecord> run(const Case& c,
                                    std::vector<StageRecord> earlier = {},
                                    int threads = 1) {
  std::vector<StageRecord> records;
  Threads pool(threads);
  run_case(c,
           std::move(earlier),
           {.trace = true},
           &pool,
           {.finished = [&](const auto& r) { records.push_back(r); }});
  return records;
}

inline std::string option(const Options& options, const std::string& key) {
  for (const auto& [name, value] : options)
    if (name == key) return value;
  return {};
}

}  // namespace physinv::test
