#include "baselines/neural_adjoint.h"

#include <cmath>

#include "baselines/boundary_loss.h"
#include "optimizers/bfgs.h"
#include "optimizers/drive.h"
#include "optimizers/minimize.h"
#include "optimizers/network_model.h"
#include "suite/core/median.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

/// L~ without the boundary, its gradient by the network's input vjp.
template <class T>
class Surrogate {
 public:
  explicit Surrogate(StageRun& run)
      : model_(run.setting.surrogate,
               run.oracle.shape(),
               run.oracle.shape().observations,
               run.threads),
        work_(run.threads),
        target_(run.oracle.observations().template cast<T>()),
        inputs_(assemble<T>(run.setting.surrogate.inputs,
                            run.oracle.start(),
                            run.oracle.given(),
                            run.oracle.observations())) {
    model_.load(run.previous->arrays);
    for (const Field f : run.setting.surrogate.inputs) {
      if (f == Field::unknowns) break;
      unknown_row_ += input_rows({f}, run.oracle.shape());
    }
  }

  /// By unknowns as the network reads them.
  void evaluate(std::span<const Index> active,
                BatchIn<double> x,
                VectorOut<double> loss,
                BatchOut<double> gradient) {
    const auto m = static_cast<Index>(active.size());
    const Network<T>& network = model_.network();
    Workspace::Scope scope(work_);
    auto in = work_.template take<T>(inputs_.rows(), m);
    auto in_bar = work_.template take<T>(inputs_.rows(), m);
    auto residual = work_.template take<T>(target_.rows(), m);
    for (Index j = 0; j < m; ++j)
      in.col(j) = inputs_.col(active[static_cast<std::size_t>(j)]);
    in.middleRows(unknown_row_, x.rows()) = x.template cast<T>();
    network.forward(
        model_.parameters(), model_.state(), in, residual, tape_, work_);
    for (Index j = 0; j < m; ++j) {
      residual.col(j) -= target_.col(active[static_cast<std::size_t>(j)]);
      loss(j) = 0.5 * residual.col(j).template cast<double>().squaredNorm();
    }
    BatchOut<T> bar(in_bar);
    network.backward(
        model_.parameters(), tape_, residual, nullptr, &bar, work_);
    gradient =
        in_bar.middleRows(unknown_row_, x.rows()).template cast<double>();
  }

  const Counts& counts() const { return work_.counts; }
  std::size_t bytes() const {
    return model_.bytes() + tape_.bytes() + work_.bytes();
  }

 private:
  NetworkModel<T> model_;
  Tape tape_;
  Workspace work_;
  Batch<T> target_, inputs_;
  Index unknown_row_ = 0;
};

/// Keeps the best true loss over the accepted iterates of each example.
class BestTrue {
 public:
  explicit BestTrue(StageRun& run)
      : run_(run),
        x_(run.oracle.start()),
        candidate_(x_),
        loss_(Vector<double>::Constant(x_.cols(), HUGE_VAL)),
        candidate_loss_(x_.cols()) {}

  void operator()(const Bfgs& solver) {
    const auto m = static_cast<Index>(solver.accepted().size());
    for (Index j = 0; j < m; ++j)
      candidate_.col(j) = solver.x().col(at(solver, j));
    run_.oracle.evaluate<double>(
        solver.accepted(), candidate_.leftCols(m), candidate_loss_.head(m));
    for (Index j = 0; j < m; ++j) {
      const Index i = at(solver, j);
      if (candidate_loss_(j) < loss_(i)) {
        loss_(i) = candidate_loss_(j);
        x_.col(i) = candidate_.col(j);
      }
      run_.probe.accept(i,
                        solver.iterations()[static_cast<std::size_t>(i)],
                        candidate_.col(j).data(),
                        candidate_loss_(j));
    }
  }

  const Batch<double>& x() const { return x_; }

 private:
  static Index at(const Bfgs& solver, Index j) {
    return solver.accepted()[static_cast<std::size_t>(j)];
  }

  StageRun& run_;
  Batch<double> x_, candidate_;
  Vector<double> loss_, candidate_loss_;
};

template <class T>
Outcome solve(const NeuralAdjointOptions& options, StageRun& run) {
  Oracle& oracle = run.oracle;
  Surrogate<T> surrogate(run);
  const Labelling& labels = run.setting.labels;
  const BoundaryLoss boundary = BoundaryLoss::over(
      bounded(oracle.labelled(labels.per_problem).x, labels), options.gamma);
  Batch<double> start = oracle.start(), gradient(start);
  Vector<double> loss(start.cols());

  run.probe.begin_warmup();
  oracle.warm_up<double>();
  surrogate.evaluate(oracle.all(), bounded(start, labels), loss, gradient);
  const double weight =
      options.fixed_weight != 0
          ? options.fixed_weight
          : options.weight * median({loss.begin(), loss.end()});

  Bfgs solver({.gtol = run.setting.gtol, .maxiter = run.iterations});
  BestTrue best(run);
  run.probe.begin();
  drive(
      solver,
      [&](std::span<const Index> active,
          BatchIn<double> x,
          VectorOut<double> l,
          BatchOut<double> g) {
        const Batch<double> read = bounded(x, labels);
        surrogate.evaluate(active, read, l, g);
        boundary.add(read, weight, l, g);
        g.topRows(labels.bounded).array() *=
            1 - read.topRows(labels.bounded).array().square();
        run.probe.trace(x.data(),
                        sizeof(double) * static_cast<std::size_t>(x.size()));
      },
      start,
      best);
  run.probe.finish();

  Outcome out = outcome_of(solver, oracle);
  out.x = best.x();
  out.bytes = surrogate.bytes();
  out.arrays["boundary_weight"] = Batch<double>::Constant(1, 1, weight);
  oracle.add(surrogate.counts());
  return out;
}

}  // namespace

std::shared_ptr<const Stage> neural_adjoint_solve(
    const NeuralAdjointOptions& options) {
  return make_stage(
      {.name = "solve",
       .needs = Needs::forward | Needs::labels,
       .options = describe(options),
       .iterations = options.iterations,
       .own_length = true,
       .networks = Networks::surrogate,
       .operations =
           [](const CaseSize& size) {
             return 60.0 * static_cast<double>(size.n) *
                    (2 * size.surrogate_operations + size.problem_operations +
                     200);
           }},
      [options]<class T>(StageRun& run) { return solve<T>(options, run); });
}

}  // namespace physinv
