#include "suite/cases/hig/quantum_dipole/direct_metrics.h"

#include <algorithm>

#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/core/oracle.h"

namespace physinv::dipole {
namespace {

void float_losses(const Snapshot& at, VectorOut<double> out) {
  out.setZero();
  if (at.y.rows() != 2 * kQuantumPoints) return;  // not of this problem
  const Batch<float> x = at.x.cast<float>(), given(0, x.cols());
  const Batch<float> target = at.oracle.observations().cast<float>();
  Batch<float> y(at.y.rows(), x.cols());
  Vector<double> loss(x.cols());
  Workspace work;
  for (const bool accurate : {false, true}) {
    const QuantumDipole<float> problem({.accurate_loss = accurate});
    problem.forward(x, given, y, work);
    problem.loss(y, target, loss);
    out(accurate ? kRest : kOverlap) =
        loss.head(std::min<Index>(kNamed, loss.size())).cwiseAbs().maxCoeff();
  }
}

}  // namespace

Metrics losses_in_float() {
  return {
      .name = "float", .rows = {"overlap", "rest"}, .evaluate = float_losses};
}

}  // namespace physinv::dipole
