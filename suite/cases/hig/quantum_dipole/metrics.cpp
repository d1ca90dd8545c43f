#include "suite/cases/hig/quantum_dipole/metrics.h"

#include <algorithm>

#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/core/any_problem.h"
#include "suite/core/oracle.h"

namespace physinv::dipole {
namespace {

void level_losses(const Snapshot& at, VectorOut<double> out) {
  out.setZero();
  if (at.y.rows() != 2 * kQuantumPoints) return;  // not of this problem
  Vector<double> loss(at.y.cols());
  quantum_level_loss<double>(2, at.y, at.oracle.observations(), loss);
  out(kLow) = loss.mean();
  quantum_level_loss<double>(3, at.y, at.oracle.observations(), loss);
  out(kHigh) = loss.mean();
}

void float_losses(const Snapshot& at, VectorOut<double> out) {
  out.setZero();
  if (at.y.rows() != 2 * kQuantumPoints) return;  // not of this problem
  const Batch<float> x = at.x.cast<float>(), given(0, x.cols());
  const Batch<float> target = at.oracle.observations().cast<float>();
  Batch<float> y(at.y.rows(), x.cols());
  Vector<double> loss(x.cols());
  Workspace work;
  for (const bool accurate : {false, true}) {
    const AnyProblem<float> problem(
        problems::quantum_dipole({.accurate_loss = accurate}));
    problem.forward(x, given, y, work);
    problem.loss(y, target, loss);
    out(accurate ? kRest : kOverlap) =
        loss.head(std::min<Index>(kNamed, loss.size())).cwiseAbs().maxCoeff();
  }
}

}  // namespace

Metrics levels() {
  return {.name = "levels", .rows = {"low", "high"}, .evaluate = level_losses};
}

Metrics losses_in_float() {
  return {
      .name = "float", .rows = {"overlap", "rest"}, .evaluate = float_losses};
}

}  // namespace physinv::dipole
