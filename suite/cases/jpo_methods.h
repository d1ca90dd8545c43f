/// The methods every experiment of the JPO paper compares.
#pragma once

#include <string>
#include <vector>

#include "baselines/neural_adjoint.h"
#include "baselines/supervised.h"
#include "optimizers/classical.h"
#include "optimizers/jpo.h"

namespace physinv {

struct JpoMethodOptions {
  double rate = 1e-4;       ///< of JPO's Adam; the other networks use 1e-3
  Index iterations = 3000;  ///< of every network, unless a row says otherwise
};

/// bfgs, gd, jpo, supervised and na, the networks' chains with refinement.
inline std::vector<Method> jpo_methods(const JpoMethodOptions& options = {}) {
  const Index iterations = options.iterations;
  return {{"bfgs", {bfgs_solve()}},
          {"gd", {gradient_descent_solve()}},
          {"jpo",
           {jpo_fit({.step = {.rate = options.rate}, .iterations = iterations}),
            bfgs_refine()}},
          {"supervised",
           {supervised_fit({.iterations = iterations}), bfgs_refine()}},
          {"na",
           {surrogate_fit({.iterations = iterations}),
            neural_adjoint_solve(),
            bfgs_refine()}}};
}

/// Those of them that train a network.
inline std::vector<std::string> trained_methods() {
  return {"jpo", "supervised", "na"};
}

}  // namespace physinv
