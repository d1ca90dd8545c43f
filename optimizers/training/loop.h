/// The loop of every training, signal x rule x batches:
///
///   while (iterations are left) { next batch; rule(signal) }
///
/// Labelled regression, joint optimization through a solver, minibatches with
/// half-inverse gradients are settings of it: which signal pushes the network,
/// which rule makes an update of that, which samples take part, and what makes
/// the estimates of the case's own problems.
#pragma once

#include <functional>

#include "optimizers/training/batches.h"
#include "optimizers/training/rule.h"

namespace physinv {

template <class T>
struct Training {
  NetworkModel<T>& model;
  Signal<T>& signal;
  Rule<T>& rule;
  Batches<T>* batches;  ///< null: the signal sees all samples every time
  /// Estimates of the case's problems, when a point of the curve is due.
  std::function<void(BatchOut<double> x)> estimate;
  /// Gets each point's estimates and their observations.
  std::function<void(BatchIn<double> x, BatchIn<double> y)> measured =
      [](BatchIn<double>, BatchIn<double>) {};
  /// What the two collect, if they do.
  std::function<void(Archive& archive)> serialize = {};
};

/// With a checkpoint, continues from the state that is there and saves one when
/// due: same bits as without.
///
/// Leaves everything but the estimates. Ends with status diverged when the
/// signal has nothing to learn from, or the rule refuses an update.
template <class T>
Outcome run_training(const Training<T>& training, StageRun& run);

extern template Outcome run_training(const Training<float>&, StageRun&);
extern template Outcome run_training(const Training<double>&, StageRun&);

}  // namespace physinv
