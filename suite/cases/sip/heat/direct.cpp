#include "suite/cases/sip/heat/direct.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "optimizers/lbfgsb.h"
#include "problems/heat/inversion.h"
#include "suite/cases/sip/heat/metrics.h"
#include "suite/core/math.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv::heat {
namespace {

constexpr double kDamped = 35;  ///< s above which an eigenspace is not moved

/// All examples, step by step.
class Solver {
 public:
  virtual ~Solver() = default;
  virtual void step() = 0;
  virtual void estimate(BatchOut<double> x) = 0;
  /// Adds statuses and counts to what has run its iterations.
  virtual void leave(Outcome&) const {}
};

class Descent final : public Solver {
 public:
  explicit Descent(StageRun& run)
      : oracle_(run.oracle),
        x_(oracle_.start()),
        gradient_(x_),
        loss_(x_.cols()) {}

  void step() override {
    oracle_.evaluate<double>(oracle_.all(), x_, loss_, gradient_);
    x_ -= gradient_;
  }
  void estimate(BatchOut<double> x) override { x = x_; }

 private:
  Oracle& oracle_;
  Batch<double> x_, gradient_;
  Vector<double> loss_;
};

/// The case's problem, with another noise floor if one is named.
Heat<double> heat_of(const StageRun& run, double noise_floor = 0) {
  const auto problem = run.oracle.recipe().make<double>();
  HeatOptions options = dynamic_cast<const Heat<double>&>(*problem).options();
  options.noise_floor = noise_floor;
  return Heat<double>(options);
}

class DescentOfModes final : public Solver {
 public:
  explicit DescentOfModes(StageRun& run)
      : heat_(heat_of(run)),
        y_(run.oracle.observations()),
        work_(run.threads) {}

  void step() override { ++steps_; }
  void estimate(BatchOut<double> x) override {
    heat_.filter(
        y_, heat_gradient_descent(heat_.exponents(), steps_), x, work_);
  }

 private:
  Heat<double> heat_;
  const Batch<double>& y_;
  Workspace work_;
  Index steps_ = 0;
};

class InversePhysics final : public Solver {
 public:
  InversePhysics(StageRun& run, double noise_floor)
      : oracle_(run.oracle),
        heat_(heat_of(run, noise_floor)),
        x_(oracle_.start()),
        work_(run.threads) {}

  void step() override {
    heat_.invert(oracle_.observations(), oracle_.given(), x_, x_, work_);
    oracle_.add(Counter::inverse, x_.cols());
  }
  void estimate(BatchOut<double> x) override { x = x_; }
  void leave(Outcome&) const override { oracle_.add(work_.counts); }

 private:
  Oracle& oracle_;
  Heat<double> heat_;
  Batch<double> x_;
  Workspace work_;
};

class InversePhysicsOfModes final : public Solver {
 public:
  InversePhysicsOfModes(StageRun& run, double noise_floor)
      : oracle_(run.oracle),
        heat_(heat_of(run, noise_floor)),
        work_(run.threads),
        inversion_(heat_, oracle_.observations(), work_) {}

  void step() override {
    inversion_.step(work_);
    oracle_.add(Counter::inverse, oracle_.count());
  }
  void estimate(BatchOut<double> x) override { inversion_.estimate(x, work_); }
  void leave(Outcome&) const override { oracle_.add(work_.counts); }

 private:
  Oracle& oracle_;
  Heat<double> heat_;
  Workspace work_;
  HeatInversion inversion_;
};

/// Eigenspaces of the diffusion: |k|^2, and how much of y each of them has.
class Eigenspaces {
 public:
  explicit Eigenspaces(const Heat<double>& heat)
      : fft_(heat.options().resolution) {
    const Batch<double>& s = heat.exponents();
    std::map<Index, Index> found;  // |k|^2 -> space
    number_ = s.unaryExpr([&](double e) -> Index {
      if (e > kDamped) return -1;
      const auto square = static_cast<Index>(std::llround(e / s(1, 0)));
      const auto [space, added] = found.try_emplace(square, count());
      if (added) damping_.push_back(math::exp(-e));
      return space->second;
    });
  }

  Index count() const { return static_cast<Index>(damping_.size()); }
  /// e^-s
  Eigen::Map<const Vector<double>> damping() const {
    return {damping_.data(), count()};
  }
  /// Length of y's part in each.
  Vector<double> lengths(VectorIn<double> y) const {
    using Lane = Pack<double, 2>;
    const Index n = fft_.size();
    Workspace work;
    auto u = work.take<double>(2, fft_.field()),
         z = work.take<double>(2, fft_.spectrum()),
         scratch = work.take<double>(2, fft_.scratch());
    u.rowwise() = y.transpose();
    const auto packs = [](auto& of) {
      return reinterpret_cast<Lane*>(of.data());
    };
    fft_.forward(packs(u), packs(z), packs(scratch));
    Vector<double> squares = Vector<double>::Zero(count());
    // Of a pair (k, l), (-k, l); those at -l have as much. What is its own
    // negative comes twice.
    const auto once = [&](Index m) { return m == 0 || 2 * m == n ? 0.5 : 1.0; };
    fft_.scale_modes(packs(z), [&](Index p, Index q, Lane re, Lane im) {
      const Index l = fft_.mode(p), k = fft_.mode(q);
      const Index r = number_(k, l);
      const double square = std::fma(re[0], re[0], im[0] * im[0]);
      if (r >= 0) squares(r) += 2 * once(k) * once(l) * square;
      return Lane{};
    });
    return squares.cwiseSqrt() / double(n);
  }
  /// A gain for every mode from one for each space.
  Batch<double> spread(const Vector<double>& gain) const {
    return number_.unaryExpr([&](Index r) { return r < 0 ? 0.0 : gain(r); });
  }

 private:
  PlaneFft fft_;
  Batch<Index> number_;  ///< of the space of a mode, -1 for none
  std::vector<double> damping_;
};

/// min sum_r (e^-s_r xi_r - |y_r|)^2 / 2 for each example.
class LbfgsbOfModes final : public Solver {
 public:
  explicit LbfgsbOfModes(StageRun& run)
      : heat_(heat_of(run)),
        spaces_(heat_),
        y_(run.oracle.observations()),
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
      heat_.filter(y_.col(i), spaces_.spread(gain), one, work_);
      x.col(i) = one;
    }
  }
  void leave(Outcome& out) const override {
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

  Heat<double> heat_;
  Eigenspaces spaces_;
  const Batch<double>& y_;
  Batch<double> lengths_;
  std::vector<Lbfgsb> solvers_;
  Workspace work_;
};

std::unique_ptr<Solver> make(const DirectOptions& options, StageRun& run) {
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

class DirectStage final : public Stage {
 public:
  explicit DirectStage(const DirectOptions& options)
      : options_(options), metrics_(metrics()) {}

  std::string name() const override { return "solve"; }
  /// All but the steps by cells know the operator's spectrum.
  Needs needs() const override {
    return Needs::forward |
           (options_.solver == Direct::descent ? Needs::vjp : Needs::inverse);
  }
  Options options() const override {
    return chained(describe(options_), describe(metrics_));
  }
  Index default_iterations() const override { return options_.iterations; }
  Networks networks() const override { return Networks::none; }
  Sources sources() const override {
    Sources all = Stage::sources();
    metrics_.add_to(all);
    return all;
  }
  double operations(const CaseSize& size) const override {
    const auto steps = static_cast<double>(size.n * size.iterations);
    switch (options_.solver) {
      case Direct::descent_modes:
        return steps;
      case Direct::lbfgsb_modes:
        return steps * 1e4;
      default:
        return steps * 3 * size.problem_operations;
    }
  }
  Outcome run(StageRun& run) const override {
    const auto solver = make(options_, run);
    MetricsRecorder recorder(metrics_, run);
    run.probe.begin_warmup();
    run.oracle.warm_up<double>();
    run.probe.begin();
    Batch<double> x(run.oracle.shape().unknowns, run.oracle.count());
    const auto estimate = [&](BatchOut<double> at) {
      solver->estimate(x);
      at = x;
    };
    const auto measured = [&](BatchIn<double> at, BatchIn<double> y) {
      recorder(Vector<double>(), at, y);
    };
    while (run.probe.proceed(estimate, measured)) solver->step();

    Outcome out;
    const auto steps = static_cast<double>(run.probe.iteration());
    out.x = std::move(x);
    out.status.assign(static_cast<std::size_t>(run.oracle.count()),
                      Status::maxiter);
    out.iterations.setConstant(run.oracle.count(), steps);
    out.evaluations = out.iterations;
    solver->leave(out);
    out.arrays["mean_loss"] = run.probe.curve().loss.colwise().mean();
    out.arrays["metrics"] = recorder.values();
    keep_finite(out.arrays);
    return out;
  }

 private:
  DirectOptions options_;
  Metrics metrics_;
};

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
  return std::make_shared<DirectStage>(options);
}

}  // namespace physinv::heat
