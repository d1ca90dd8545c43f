#include "suite/cases/sip/heat/direct.h"

#include <vector>

#include "optimizers/lbfgsb.h"
#include "optimizers/stage.h"
#include "optimizers/stepwise.h"
#include "problems/heat/eigenspaces.h"
#include "problems/heat/inversion.h"
#include "suite/cases/sip/heat/metrics.h"
#include "suite/core/any_problem.h"
#include "suite/core/check.h"
#include "suite/core/oracle.h"

namespace physinv::heat {
namespace {

constexpr double kDamped = 35;  ///< s above which an eigenspace is not moved

class Solver : public StepwiseSolver {
 public:
  explicit Solver(StageRun& run) : oracle_(run.oracle) {}
  void warm_up() override { oracle_.warm_up<double>(); }

 protected:
  Oracle& oracle_;
};

class Descent final : public Solver {
 public:
  explicit Descent(StageRun& run)
      : Solver(run), x_(oracle_.start()), gradient_(x_), loss_(x_.cols()) {}

  void step() override {
    oracle_.evaluate<double>(oracle_.all(), x_, loss_, gradient_);
    x_ -= gradient_;
  }
  void estimate(BatchOut<double> x) override { x = x_; }

 private:
  Batch<double> x_, gradient_;
  Vector<double> loss_;
};

/// Those of the case's problem, with another noise floor if one is named.
HeatOptions heat_of(const StageRun& run, double noise_floor = 0) {
  const HeatOptions* of_case = heat_options(run.oracle.inspect());
  SUITE_CHECK(of_case != nullptr,
              "these solvers only work for the heat problem");
  HeatOptions options = *of_case;
  options.noise_floor = noise_floor;
  return options;
}

class DescentOfModes final : public Solver {
 public:
  explicit DescentOfModes(StageRun& run)
      : Solver(run),
        heat_(heat_of(run)),
        y_(oracle_.observations()),
        work_(run.threads) {}

  void step() override { ++steps_; }
  void estimate(BatchOut<double> x) override {
    heat_.filter<double>(
        y_, heat_gradient_descent(heat_.exponents(), steps_), x, work_);
  }

 private:
  HeatModes heat_;
  const Batch<double>& y_;
  Workspace work_;
  Index steps_ = 0;
};

class InversePhysics final : public Solver {
 public:
  InversePhysics(StageRun& run, double noise_floor)
      : Solver(run),
        heat_(problems::heat(heat_of(run, noise_floor))),
        x_(oracle_.start()),
        work_(run.threads) {}

  void step() override {
    heat_.invert(oracle_.observations(), oracle_.given(), x_, x_, work_);
    oracle_.add(Counter::inverse, x_.cols());
  }
  void estimate(BatchOut<double> x) override { x = x_; }
  void export_to(Outcome&) override { oracle_.add(work_.counts); }

 private:
  AnyProblem<double> heat_;
  Batch<double> x_;
  Workspace work_;
};

class InversePhysicsOfModes final : public Solver {
 public:
  InversePhysicsOfModes(StageRun& run, double noise_floor)
      : Solver(run),
        heat_(heat_of(run, noise_floor)),
        work_(run.threads),
        inversion_(heat_, oracle_.observations(), work_) {}

  void step() override {
    inversion_.step(work_);
    oracle_.add(Counter::inverse, oracle_.count());
  }
  void estimate(BatchOut<double> x) override { inversion_.estimate(x, work_); }
  void export_to(Outcome&) override { oracle_.add(work_.counts); }

 private:
  HeatModes heat_;
  Workspace work_;
  HeatInversion inversion_;
};

/// min sum_r (e^-s_r xi_r - |y_r|)^2 / 2 for each example.
class LbfgsbOfModes final : public Solver {
 public:
  explicit LbfgsbOfModes(StageRun& run)
      : Solver(run),
        heat_(heat_of(run)),
        spaces_(heat_, kDamped),
        y_(oracle_.observations()),
        lengths_(spaces_.count(), y_.cols()),
        work_(run.threads) {
    solvers_.reserve(static_cast<std::size_t>(y_.cols()));
    for (Index i = 0; i < y_.cols(); ++i) {
      lengths_.col(i) = spaces_.lengths(y_.col(i));
      solvers_.emplace_back(
          LbfgsbOptions{.memory = 10, .pgtol = 1e-14, .ftol = 1e-14});
      solvers_.back().start(Batch<double>::Zero(spaces_.count(), 1));
      advance(i);  // to the start itself
    }
  }

  void step() override {
    for (Index i = 0; i < y_.cols(); ++i) advance(i);
  }
  void estimate(BatchOut<double> x) override {
    Batch<double> one(x.rows(), 1);
    for (Index i = 0; i < x.cols(); ++i) {
      const Vector<double> xi = at(i).x().col(0);
      const Vector<double> gain =
          (lengths_.col(i).array() > 0)
              .select(xi.array() / lengths_.col(i).array(), 0.0);
      heat_.filter<double>(y_.col(i), spaces_.spread(gain), one, work_);
      x.col(i) = one;
    }
  }
  void export_to(Outcome& out) override {
    for (std::size_t i = 0; i < solvers_.size(); ++i) {
      const Lbfgsb& s = solvers_[i];
      const auto k = static_cast<Index>(i);
      out.status[i] = s.pending() ? Status::maxiter : s.status().front();
      out.iterations(k) = static_cast<double>(s.iterations().front());
      out.evaluations(k) = static_cast<double>(s.evaluations().front());
    }
  }

 private:
  Lbfgsb& at(Index i) { return solvers_[static_cast<std::size_t>(i)]; }

  /// To the next accepted step, if there is one.
  void advance(Index i) {
    Lbfgsb& solver = at(i);
    Vector<double> loss(1), gradient(spaces_.count());
    while (solver.pending()) {
      if (!solver.supply_known()) {
        const auto q = spaces_.damping().array();
        const Vector<double> away =
            q * solver.points().col(0).array() - lengths_.col(i).array();
        loss(0) = 0.5 * away.squaredNorm();
        gradient = q * away.array();
        solver.supply(loss, gradient);
      }
      if (!solver.accepted().empty()) return;
    }
  }

  HeatModes heat_;
  HeatEigenspaces spaces_;
  const Batch<double>& y_;
  Batch<double> lengths_;
  std::vector<Lbfgsb> solvers_;
  Workspace work_;
};

std::unique_ptr<StepwiseSolver> make(const DirectOptions& options,
                                     StageRun& run) {
  switch (options.solver) {
    case Direct::descent:
      break;
    case Direct::descent_modes:
      return std::make_unique<DescentOfModes>(run);
    case Direct::lbfgsb_modes:
      return std::make_unique<LbfgsbOfModes>(run);
    case Direct::inverse_physics:
      return std::make_unique<InversePhysics>(run, options.noise_floor);
    case Direct::inverse_physics_modes:
      return std::make_unique<InversePhysicsOfModes>(run, options.noise_floor);
  }
  return std::make_unique<Descent>(run);
}

double operations(Direct solver, const CaseSize& size) {
  const auto steps = static_cast<double>(size.n * size.iterations);
  switch (solver) {
    case Direct::descent_modes:
      return steps;
    case Direct::lbfgsb_modes:
      return steps * 1e4;
    default:
      return steps * 3 * size.problem_operations;
  }
}

}  // namespace

std::string_view to_string(Direct solver) {
  constexpr std::string_view kNames[] = {"descent",
                                         "descent_modes",
                                         "lbfgsb_modes",
                                         "inverse_physics",
                                         "inverse_physics_modes"};
  return kNames[static_cast<std::size_t>(solver)];
}

std::shared_ptr<const Stage> direct(const DirectOptions& options) {
  const Metrics recorded = metrics();
  Sources sources;
  recorded.add_to(sources);
  // All but the steps by cells know the operator's spectrum.
  const bool cells = options.solver == Direct::descent;
  return make_stage(
      {.name = "solve",
       .needs = Needs::forward | (cells ? Needs::vjp : Needs::inverse),
       .options = chained(describe(options), describe(recorded)),
       .iterations = options.iterations,
       .networks = Networks::none,
       .operations =
           [solver = options.solver](const CaseSize& size) {
             return operations(solver, size);
           },
       .sources = sources},
      [options, recorded](StageRun& run) {
        const auto solver = make(options, run);
        return run_steps(*solver, run, recorded);
      });
}

}  // namespace physinv::heat
