/// The methods every experiment of the JPO paper compares.
#pragma once

#include <string>
#include <vector>

#include "baselines/neural_adjoint.h"
#include "baselines/supervised.h"
#include "baselines/surrogate.h"
#include "optimizers/classical.h"
#include "optimizers/jpo.h"
#include "suite/harness/case.h"

namespace physinv {

struct JpoMethodOptions {
  double rate = 1e-4;       ///< of JPO's Adam; the other networks use 1e-3
  Index iterations = 3000;  ///< of every network, unless a row says otherwise
  Index bfgs_iterations = 1000;     ///< of BFGS and of refinement, at most
  Index descent_iterations = 1000;  ///< of gradient descent, at most
};

/// bfgs, gd, jpo, supervised and na, the networks' chains with refinement.
inline std::vector<Method> jpo_methods(const JpoMethodOptions& options = {}) {
  const Index iterations = options.iterations;
  const auto refine = bfgs_refine({.iterations = options.bfgs_iterations});
  return {
      {"bfgs", {bfgs_solve({.iterations = options.bfgs_iterations})}},
      {"gd",
       {gradient_descent_solve({.iterations = options.descent_iterations})}},
      {"jpo",
       {jpo_fit({.step = AdamOptions{.rate = options.rate},
                 .iterations = iterations}),
        refine}},
      {"supervised", {supervised_fit({.iterations = iterations}), refine}},
      {"na",
       {surrogate_fit({.iterations = iterations}),
        neural_adjoint_solve(),
        refine}}};
}

/// Those of them that train a network.
inline std::vector<std::string> trained_methods() {
  return {"jpo", "supervised", "na"};
}

/// Solvers and networks on the same problems of the first seeds, each network
/// for so many iterations.
inline std::vector<Row> jpo_rows(const std::vector<Index>& n,
                                 std::uint64_t seeds,
                                 Index iterations,
                                 const std::vector<std::string>& solvers = {
                                     "bfgs", "gd"}) {
  return {{.methods = solvers, .n = n, .seeds = first_seeds(seeds)},
          {.methods = trained_methods(),
           .n = n,
           .seeds = first_seeds(seeds),
           .iterations = iterations}};
}

}  // namespace physinv
