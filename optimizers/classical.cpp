#include "optimizers/classical.h"

#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "optimizers/bfgs.h"
#include "optimizers/bold_descent.h"
#include "optimizers/gradient_descent.h"
#include "optimizers/lbfgsb.h"
#include "optimizers/minimize.h"
#include "optimizers/stage.h"
#include "suite/core/check.h"

namespace physinv {
namespace {

/// All stages are in this file; each has its own solver.
Sources only(const char* used) {
  Sources sources;
  for (const std::string header : {"optimizers/bfgs.h",
                                   "optimizers/bold_descent.h",
                                   "optimizers/gradient_descent.h",
                                   "optimizers/lbfgsb.h"})
    if (header != used)
      sources.unused.emplace_back("optimizers/classical.cpp", header);
  return sources;
}

/// Facts of stage `solve`; `header` is that of its solver.
StageFacts facts(const char* header,
                 Options options,
                 Index iterations,
                 std::function<double(const CaseSize&)> operations) {
  return {.name = "solve",
          .needs = Needs::forward | Needs::vjp,
          .options = std::move(options),
          .iterations = iterations,
          .networks = Networks::none,
          .operations = std::move(operations),
          .sources = only(header)};
}

/// Tens of evaluations are typical, each with its share of line search.
double of_line_searches(const CaseSize& size, double search) {
  return 40.0 * static_cast<double>(size.n) *
         (3 * size.problem_operations + search);
}

void check_step(double first) {
  SUITE_CHECK(std::isfinite(first) && first > 0, "first_step must be positive");
}

double of_evaluations(const CaseSize& size) {
  return static_cast<double>(size.n * size.iterations) *
         (3 * size.problem_operations + 100);
}

std::shared_ptr<const Stage> bfgs(const BfgsStageOptions& options,
                                  bool refines) {
  SUITE_CHECK(options.stall >= 0 && options.search_evaluations >= 0 &&
                  options.gtol >= 0,
              "stall, search_evaluations and gtol must not be negative");
  StageFacts stage = facts(
      "optimizers/bfgs.h",
      chained({{"algorithm", "bfgs"}, {"from", refines ? "previous" : "start"}},
              describe(options)),
      options.iterations,
      [](const CaseSize& size) {
        const auto d = static_cast<double>(size.shape.unknowns);
        return of_line_searches(size, 200 + 4 * d * d);
      });
  if (refines) stage.name = "refine", stage.own_length = true;
  return make_stage(std::move(stage), [options, refines](StageRun& run) {
    BfgsOptions bfgs{.gtol = options.gtol > 0 ? options.gtol : run.setting.gtol,
                     .maxiter = run.iterations,
                     .stall = options.stall,
                     .first_trial = options.first_trial};
    bfgs.search.back_off = options.back_off;
    if (options.search_evaluations > 0)
      bfgs.search.max_together = options.search_evaluations;
    Bfgs solver(bfgs);
    return minimize(solver,
                    run,
                    refines ? run.previous->x : run.oracle.start(),
                    options.single ? Precision::f32 : Precision::f64);
  });
}

}  // namespace

std::shared_ptr<const Stage> bfgs_solve(const BfgsStageOptions& options) {
  return bfgs(options, false);
}

std::shared_ptr<const Stage> bfgs_refine(const BfgsStageOptions& options) {
  return bfgs(options, true);
}

std::shared_ptr<const Stage> lbfgsb_solve(const LbfgsbStageOptions& options) {
  const auto operations = [memory = options.memory](const CaseSize& size) {
    const auto d = static_cast<double>(size.shape.unknowns);
    const auto m = static_cast<double>(memory);
    return of_line_searches(size, 500 + 12 * m * d);
  };
  return make_stage(facts("optimizers/lbfgsb.h",
                          describe(options),
                          options.iterations,
                          operations),
                    [options](StageRun& run) {
                      Lbfgsb solver({.memory = options.memory,
                                     .pgtol = run.setting.gtol,
                                     .ftol = options.ftol,
                                     .maxiter = run.iterations,
                                     .lower = options.lower,
                                     .upper = options.upper});
                      return minimize(solver, run, run.oracle.start());
                    });
}

std::shared_ptr<const Stage> gradient_descent_solve(
    const GradientDescentStageOptions& options) {
  check_step(options.first_step);
  const auto operations = [](const CaseSize& size) {
    return 0.5 * of_evaluations(size);
  };
  return make_stage(
      facts("optimizers/gradient_descent.h",
            describe(options),
            options.iterations,
            operations),
      [options](StageRun& run) {
        GradientDescent solver({.first_step = options.first_step,
                                .step_tolerance = run.setting.gtol,
                                .maxiter = run.iterations});
        return minimize(solver, run, run.oracle.start());
      });
}

std::shared_ptr<const Stage> bold_descent_solve(
    const BoldDescentStageOptions& options) {
  check_step(options.first_step);
  return make_stage(facts("optimizers/bold_descent.h",
                          describe(options),
                          options.evaluations,
                          of_evaluations),
                    [options](StageRun& run) {
                      BoldDescent solver({.first_step = options.first_step,
                                          .evaluations = run.iterations});
                      return minimize(solver, run, run.oracle.start());
                    });
}

}  // namespace physinv
