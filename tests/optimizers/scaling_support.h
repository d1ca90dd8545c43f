/// The scaling with any target, and what a stage of local steps makes of it.
#pragma once

#include <array>

#include "optimizers/local_steps.h"
#include "problems/scaling/scaling.h"
#include "tests/support/listed.h"
#include "tests/support/quadratic.h"

namespace physinv::test {

struct AimedOptions {
  ScalingOptions scaling = {};
  std::array<double, 2> target = {0, 0};
  auto fields() const {
    return std::tuple{field("scaling", scaling), field("target", target)};
  }
};

/// Without the closed steps.
template <class T>
class Open : public Listed<T> {
 public:
  using Options = AimedOptions;
  explicit Open(const Options& options = {})
      : Listed<T>(problems::scaling(options.scaling), {}), options_(options) {}

  void draw(Stream& stream, SampleOut& sample) const override {
    this->of_.problem().draw(stream, sample);
    sample.y << options_.target[0], options_.target[1];
  }
  Drawn drawn() const override { return Drawn::both; }

 private:
  AimedOptions options_;
};

template <class T>
class Aimed final : public Open<T>, public ClosedSteps<T> {
 public:
  using Open<T>::Open;

  void newton_step(Point<T> at,
                   BatchIn<T> target,
                   BatchOut<T> dx) const override {
    this->of_.newton_step(at.x, at.given, target, dx);
  }
  void inverse_gradient_step(Point<T> at,
                             BatchIn<T> target,
                             BatchOut<T> dx) const override {
    this->of_.inverse_gradient_step(at.x, at.given, target, dx);
  }
};

inline CountedProblem<double> counted_scaling(
    const ScalingOptions& options = {}) {
  return {problems::scaling(options).make<double>(),
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
