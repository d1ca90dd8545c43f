#include "suite/cases/hig/quantum_dipole/metrics.h"

#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/core/oracle.h"

namespace physinv::dipole {
namespace {

void level_losses(const Snapshot& at, VectorOut<double> out) {
  out.setZero();
  if (at.y.rows() != 2 * kQuantumPoints) return;  // not of this problem
  const QuantumDipole<double> problem;
  Vector<double> loss(at.y.cols());
  problem.level_loss(2, at.y, at.oracle.observations(), loss);
  out(kLow) = loss.mean();
  problem.level_loss(3, at.y, at.oracle.observations(), loss);
  out(kHigh) = loss.mean();
}

}  // namespace

Metrics levels() {
  return {.name = "levels", .rows = {"low", "high"}, .evaluate = level_losses};
}

}  // namespace physinv::dipole
