/// Classical optimizers as stages: every problem of a case by itself, in
/// double, all pending evaluations of a round in one batch. Array `first_step`
/// (1 x examples): length of the first accepted step, 0 if there is none.
///
///   {"bfgs", {bfgs_solve()}}            from the experiment's start
///   {"jpo", {jpo_fit(), bfgs_refine()}} from what the stage before left
#pragma once

#include <memory>
#include <vector>

#include "optimizers/steps/first_trial.h"
#include "suite/core/method.h"

namespace physinv {

struct BfgsStageOptions {
  Index iterations = 1000;
  double stall = 0;            ///< as of BfgsOptions (bfgs.h)
  int search_evaluations = 0;  ///< of a line search at most, 0: as SciPy's
  double gtol = 0;             ///< 0: the experiment's
  /// Losses and gradients are evaluated in float and the losses rounded to it;
  /// array `own_loss` (1 x examples) has those of the estimates.
  bool single = false;
  FirstTrial first_trial = FirstTrial::scipy;
  /// Line searches halve their interval at NaN, too, instead of ending there.
  bool back_off = false;

  auto fields() const {
    return std::tuple{if_changed(field("stall", stall)),
                      if_changed(field("search", search_evaluations)),
                      if_changed(field("gtol", gtol)),
                      if_changed(field("single", single)),
                      if_changed(field("first_trial", first_trial)),
                      if_changed(field("back_off", back_off)),
                      implied(iterations)};
  }
};

/// Stage `solve`: BFGS on the true loss from the start.
std::shared_ptr<const Stage> bfgs_solve(const BfgsStageOptions& options = {});

/// Stage `refine`: BFGS on the true loss from the previous estimates. One that
/// cannot start (its loss is not finite) keeps its start and status nonfinite.
std::shared_ptr<const Stage> bfgs_refine(const BfgsStageOptions& options = {});

struct LbfgsbStageOptions {
  Index iterations = 15000;
  Index memory = 10;
  double ftol = 2.2204460492503131e-09;  ///< as of LbfgsbOptions (lbfgsb.h)
  std::vector<double> lower = {}, upper = {};

  auto fields() const {
    return std::tuple{word("algorithm", "lbfgsb"),
                      field("memory", memory),
                      field("ftol", ftol),
                      field("lower", lower),
                      field("upper", upper),
                      implied(iterations)};
  }
};

/// Stage `solve`: L-BFGS-B on the true loss from the start, within bounds if
/// there are any.
std::shared_ptr<const Stage> lbfgsb_solve(
    const LbfgsbStageOptions& options = {});

struct GradientDescentStageOptions {
  Index iterations = 1000;
  double first_step = 0.1;  ///< times the gradient

  auto fields() const {
    return std::tuple{word("algorithm", "gradient_descent"),
                      if_changed(field("first_step", first_step)),
                      implied(iterations)};
  }
};

struct BoldDescentStageOptions {
  Index evaluations = 100;
  double first_step = 0.1;  ///< times the gradient, of length 1 at most

  auto fields() const {
    return std::tuple{word("algorithm", "bold_descent"),
                      if_changed(field("first_step", first_step)),
                      implied(evaluations)};
  }
};

/// Stage `solve`: gradient descent of a bold driver (bold_descent.h).
std::shared_ptr<const Stage> bold_descent_solve(
    const BoldDescentStageOptions& options = {});

/// Stage `solve`: gradient descent with an adaptive step per problem.
std::shared_ptr<const Stage> gradient_descent_solve(
    const GradientDescentStageOptions& options = {});

}  // namespace physinv
