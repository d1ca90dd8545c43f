/// The scaling with any target, and what a stage of local steps makes of it.
#pragma once

#include <array>

#include "optimizers/local_steps.h"
#include "problems/scaling/scaling.h"
#include "tests/support/quadratic.h"

namespace physinv::test {

struct AimedOptions {
  ScalingOptions scaling = {};
  std::array<double, 2> target = {0, 0};
  auto fields() const {
    return std::tuple{field("scaling", scaling), field("target", target)};
  }
};

template <class T>
class Aimed final : public Scaling<T> {
 public:
  using Options = AimedOptions;
  explicit Aimed(const Options& options = {})
      : Scaling<T>(options.scaling), target_(options.target) {}

  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override {
    Samples<double> s = Scaling<T>::sample(first, count, rng);
    s.y.colwise() = Eigen::Vector2d(target_[0], target_[1]);
    return s;
  }

 private:
  std::array<double, 2> target_;
};

inline CountedProblem<double> counted_scaling(
    const ScalingOptions& options = {}) {
  return {std::make_unique<Scaling<double>>(options),
          Needs::forward | Needs::vjp};
}

struct StepsRun {
  Outcome out;
  Batch<double> given;
};

/// With the path of every problem.
inline StepsRun run_steps(const ProblemRecipe& problem,
                          LocalStepsOptions options,
                          Index steps,
                          Precision precision = Precision::f64,
                          Index n = 1) {
  options.paths = n;
  const auto stage = local_steps(options);
  StageBench bench(*stage, n, steps, problem);
  return {bench.run(nullptr, precision), bench.oracle.given()};
}

/// Iterates of the first problem as columns.
template <class T>
Batch<double> path_of(const AimedOptions& problem_options,
                      LocalStep step,
                      double rate,
                      Index steps) {
  return run_steps(problem<Aimed>("scaling", problem_options),
                   {.step = step, .rate = rate},
                   steps,
                   sizeof(T) == 4 ? Precision::f32 : Precision::f64)
      .out.arrays.at("path");
}

}  // namespace physinv::test
