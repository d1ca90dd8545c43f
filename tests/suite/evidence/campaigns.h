// Hand-made campaigns of an experiment called "toy".
#pragma once

#include <string>
#include <vector>

#include "suite/results/results.h"

namespace physinv {

inline Vector<double> losses(const std::vector<double>& values) {
  return Eigen::Map<const Vector<double>>(values.data(),
                                          static_cast<Index>(values.size()));
}

inline StageRecord stage_of(const std::string& name,
                            const std::vector<double>& loss,
                            const std::vector<double>& start = {}) {
  StageRecord s;
  s.stage = name;
  s.key = name;
  s.loss = losses(loss);
  s.x = Batch<double>::Ones(2, s.loss.size());
  s.iterations = 5;
  s.clocks.solve = {2, 2};
  if (!start.empty()) {
    s.curve.iteration = {0, 5};
    s.curve.loss.resize(s.loss.size(), 2);
    s.curve.loss << losses(start), s.loss;
    s.curve.x = Batch<double>::Constant(2 * s.loss.size(), 2, 0.5);
  }
  return s;
}

inline CaseRecord case_of(const std::string& method,
                          Index n,
                          std::uint64_t seed,
                          const std::vector<std::string>& chain,
                          std::vector<StageRecord> stages) {
  CaseRecord c;
  c.info.experiment = "toy";
  c.info.method = method;
  c.info.name = "toy/" + method + "/n=" + std::to_string(n) +
                "/seed=" + std::to_string(seed);
  c.info.n = n;
  c.info.seed = seed;
  c.info.stages = chain;
  c.info.keys = chain;
  c.data.x = Batch<double>::Constant(2, n, 0.25);
  for (std::size_t i = 0; i < stages.size(); ++i) {
    stages[i].case_name = c.info.name;
    stages[i].position = static_cast<Index>(i);
  }
  c.stages = std::move(stages);
  return c;
}

}  // namespace physinv
