#include "optimizers/classical.h"

#include <algorithm>
#include <utility>

#include "optimizers/bfgs.h"
#include "optimizers/bold_descent.h"
#include "optimizers/drive.h"
#include "optimizers/gradient_descent.h"
#include "optimizers/lbfgsb.h"
#include "optimizers/solver_outcome.h"
#include "suite/core/check.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

/// Minimizes the true losses from x0 and leaves the curve with the probe.
template <class Solver>
Outcome solve(Solver& solver, StageRun& run, const Batch<double>& x0) {
  Oracle& oracle = run.oracle;
  Batch<double> first_step = Batch<double>::Zero(1, x0.cols());
  run.probe.begin_warmup();
  oracle.warm_up<double>();
  run.probe.begin();
  drive(
      solver,
      [&](std::span<const Index> active,
          BatchIn<double> x,
          VectorOut<double> loss,
          BatchOut<double> gradient) {
        oracle.evaluate<double>(active, x, loss, gradient);
        run.probe.trace(x.data(),
                        sizeof(double) * static_cast<std::size_t>(x.size()));
      },
      x0,
      [&](const Solver& s) {
        for (const Index i : s.accepted()) {
          const Index k = s.iterations()[static_cast<std::size_t>(i)];
          run.probe.accept(i, k, s.x().col(i).data(), s.loss()(i));
          if (k == 1) first_step(0, i) = (s.x().col(i) - x0.col(i)).norm();
        }
      });
  run.probe.finish();
  Outcome out = solver_outcome(solver, oracle);
  out.arrays["first_step"] = std::move(first_step);
  return out;
}

/// All stages stand here; each has a solver of its own.
Sources only(const char* used, Sources sources) {
  for (const std::string header : {"optimizers/bfgs.h",
                                   "optimizers/bold_descent.h",
                                   "optimizers/gradient_descent.h",
                                   "optimizers/lbfgsb.h"})
    if (header != used)
      sources.unused.emplace_back("optimizers/classical.cpp", header);
  return sources;
}

class BfgsStage final : public Stage {
 public:
  BfgsStage(const BfgsStageOptions& options, bool refines)
      : options_(options), refines_(refines) {
    SUITE_CHECK(options.stall >= 0 && options.search_evaluations >= 0,
                "stall and search_evaluations are numbers from 0 on");
  }

  std::string name() const override { return refines_ ? "refine" : "solve"; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  Options options() const override {
    return chained(
        {{"algorithm", "bfgs"}, {"from", refines_ ? "previous" : "start"}},
        describe(options_));
  }
  Index default_iterations() const override { return options_.iterations; }
  Networks networks() const override { return Networks::none; }
  Sources sources() const override {
    return only("optimizers/bfgs.h", Stage::sources());
  }
  bool takes_row_iterations() const override { return !refines_; }
  double operations(const CaseSize& size) const override {
    // Tens of evaluations are typical, each with its share of line search.
    const double d = static_cast<double>(size.shape.unknowns);
    return 40.0 * static_cast<double>(size.n) *
           (3 * size.problem_operations + 200 + 4 * d * d);
  }
  Outcome run(StageRun& run) const override {
    BfgsOptions options{.gtol = run.setting.gtol,
                        .maxiter = run.iterations,
                        .stall = options_.stall};
    if (options_.search_evaluations > 0)
      options.search.max_together = options_.search_evaluations;
    Bfgs solver(options);
    return solve(solver, run, refines_ ? run.previous->x : run.oracle.start());
  }

 private:
  BfgsStageOptions options_;
  bool refines_;
};

class LbfgsbStage final : public Stage {
 public:
  explicit LbfgsbStage(const LbfgsbStageOptions& options) : options_(options) {}

  std::string name() const override { return "solve"; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  Options options() const override { return describe(options_); }
  Index default_iterations() const override { return options_.iterations; }
  Networks networks() const override { return Networks::none; }
  Sources sources() const override {
    return only("optimizers/lbfgsb.h", Stage::sources());
  }
  double operations(const CaseSize& size) const override {
    const double d = static_cast<double>(size.shape.unknowns);
    const double m = static_cast<double>(options_.memory);
    return 40.0 * static_cast<double>(size.n) *
           (3 * size.problem_operations + 500 + 12 * m * d);
  }
  Outcome run(StageRun& run) const override {
    Lbfgsb solver({.memory = options_.memory,
                   .pgtol = run.setting.gtol,
                   .ftol = options_.ftol,
                   .maxiter = run.iterations,
                   .lower = options_.lower,
                   .upper = options_.upper});
    return solve(solver, run, run.oracle.start());
  }

 private:
  LbfgsbStageOptions options_;
};

class GradientDescentStage final : public Stage {
 public:
  explicit GradientDescentStage(const GradientDescentStageOptions& options)
      : options_(options) {}

  std::string name() const override { return "solve"; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  Options options() const override { return describe(options_); }
  Index default_iterations() const override { return options_.iterations; }
  Networks networks() const override { return Networks::none; }
  Sources sources() const override {
    return only("optimizers/gradient_descent.h", Stage::sources());
  }
  double operations(const CaseSize& size) const override {
    return 0.5 * static_cast<double>(size.n * size.iterations) *
           (3 * size.problem_operations + 100);
  }
  Outcome run(StageRun& run) const override {
    GradientDescent solver(
        {.step_tolerance = run.setting.gtol, .maxiter = run.iterations});
    return solve(solver, run, run.oracle.start());
  }

 private:
  GradientDescentStageOptions options_;
};

class BoldDescentStage final : public Stage {
 public:
  explicit BoldDescentStage(const BoldDescentStageOptions& options)
      : options_(options) {}

  std::string name() const override { return "solve"; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  Options options() const override { return describe(options_); }
  Index default_iterations() const override { return options_.evaluations; }
  Networks networks() const override { return Networks::none; }
  Sources sources() const override {
    return only("optimizers/bold_descent.h", Stage::sources());
  }
  double operations(const CaseSize& size) const override {
    return static_cast<double>(size.n * size.iterations) *
           (3 * size.problem_operations + 100);
  }
  Outcome run(StageRun& run) const override {
    BoldDescent solver({.evaluations = run.iterations});
    return solve(solver, run, run.oracle.start());
  }

 private:
  BoldDescentStageOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> bold_descent_solve(
    const BoldDescentStageOptions& options) {
  return std::make_shared<BoldDescentStage>(options);
}

std::shared_ptr<const Stage> bfgs_solve(const BfgsStageOptions& options) {
  return std::make_shared<BfgsStage>(options, false);
}

std::shared_ptr<const Stage> bfgs_refine(const BfgsStageOptions& options) {
  return std::make_shared<BfgsStage>(options, true);
}

std::shared_ptr<const Stage> lbfgsb_solve(const LbfgsbStageOptions& options) {
  return std::make_shared<LbfgsbStage>(options);
}

std::shared_ptr<const Stage> gradient_descent_solve(
    const GradientDescentStageOptions& options) {
  return std::make_shared<GradientDescentStage>(options);
}

}  // namespace physinv
