/// Runs a batched solver to its end.
#pragma once

#include <concepts>
#include <span>
#include <type_traits>

#include "optimizers/batched_solver.h"
#include "suite/core/batch.h"

namespace physinv {

/// Losses and gradients of independent problems, in one batch. Column j of x
/// belongs to problem active[j]; loss and gradient are filled in that order.
///   f(active, x, loss, gradient)
template <class F>
concept BatchObjective = std::invocable<F&,
                                        std::span<const Index>,
                                        BatchIn<double>,
                                        VectorOut<double>,
                                        BatchOut<double>>;

/// An observer that only lets time pass.
struct NoObserver {
  template <class Solver>
  void operator()(const Solver&) const {}
};

/// Evaluates the pending points of all problems as one batch per round.
///
/// `observer(solver)` is called after every round that accepted an iterate,
/// the start included: solver.accepted() says which problems moved, x(),
/// loss() and iterations() where to. One that returns a value convertible to
/// bool ends the run with `false`; what is pending then ends as `maxiter`.
template <std::derived_from<BatchedSolver> Solver,
          BatchObjective Objective,
          class Observer = NoObserver>
void drive(Solver& solver,
           Objective&& objective,
           BatchIn<double> x0,
           Observer&& observer = {}) {
  Vector<double> loss(x0.cols());
  Batch<double> gradient(x0.rows(), x0.cols());
  solver.start(x0);
  const auto observe = [&] {
    if (solver.accepted().empty()) return;
    using Answer = std::invoke_result_t<Observer&, const Solver&>;
    if constexpr (std::convertible_to<Answer, bool>) {
      if (!observer(static_cast<const Solver&>(solver))) solver.halt();
    } else {
      observer(static_cast<const Solver&>(solver));
    }
  };
  while (solver.pending()) {
    const auto m = static_cast<Index>(solver.active().size());
    objective(
        solver.active(), solver.points(), loss.head(m), gradient.leftCols(m));
    solver.supply(loss.head(m), gradient.leftCols(m));
    observe();
    while (solver.supply_known()) observe();
  }
}

}  // namespace physinv
