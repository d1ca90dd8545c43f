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

/// A curve of a point every ten updates; a row of metrics has its squares.
inline CaseRecord trained_case(const char* method,
                               std::uint64_t seed,
                               const std::vector<double>& loss) {
  StageRecord s = stage_of("fit", {loss.back()});
  const auto points = static_cast<Index>(loss.size());
  s.arrays["mean_loss"] =
      Eigen::Map<const Batch<double>>(loss.data(), 1, points);
  s.arrays["metrics"] = s.arrays["mean_loss"].array().square();
  s.arrays["late_error"] = Batch<double>::Constant(1, 1, 7);
  s.options = {{"batch", "64"}, {"rate", "1e-3"}, {"rule", "adam"}};
  for (Index k = 0; k < points; ++k)
    s.curve.iteration.push_back(10 * static_cast<double>(k));
  s.curve.seconds = s.curve.iteration;
  return case_of(method, 4, seed, {"fit"}, {std::move(s)});
}

}  // namespace physinv
