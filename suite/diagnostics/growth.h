/// How derivatives and perturbations grow with the length of a simulation, in
/// both precisions: what chaos costs a method that differentiates through it.
///
/// Arrays, samples x horizons (-1: not finite):
///   gradient, gradient_single              |dL/dx| at the start
///   gradient_error                         |g_32 - g_64| / |g_64|
///   perturbation, perturbation_single      |F(u0 + d) - F(u0)| / |d|, at the
///     true x, d = 1e-8 |u0| (float: 1e-3) along another sample's side input
///   rounding                               |F_32(u0) - F_64(u0)| / |F_64(u0)|
/// `time` (1 x horizons).
#pragma once

#include <memory>
#include <vector>

#include "suite/diagnostics/diagnostic.h"

namespace physinv {

struct Horizon {
  double time = 0;
  ProblemRecipe problem;  ///< that ends at `time`

  auto fields() const {
    return std::tuple{field("time", time), implied(problem)};
  }
};

struct GrowthOptions {
  std::string name = "growth";  ///< of the stage
  std::vector<Horizon> horizons;

  auto fields() const {
    return std::tuple{field("times", horizons),
                      word("problems", fingerprint(problems())),
                      implied(name)};
  }
  std::vector<ProblemRecipe> problems() const;
};

std::shared_ptr<const Stage> growth(GrowthOptions options);

}  // namespace physinv
