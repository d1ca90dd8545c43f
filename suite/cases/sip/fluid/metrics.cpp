#include "suite/cases/sip/fluid/metrics.h"

#include "problems/marker_flow/marker_flow.h"
#include "suite/core/oracle.h"

namespace physinv::fluid_case {
namespace {

void evaluate(const Snapshot& s, VectorOut<double> values) {
  values.setZero();
  const MarkerFlowOptions* flow = marker_flow_options(s.oracle.inspect());
  if (flow == nullptr) return;  // these numbers are of no other problem
  const Vortex vortex = flow->turning();
  const Batch<double>& truth = s.oracle.data().x;
  const Index n = vortex.grid.cells, cells = n * n;
  Batch<double> small = truth;
  double off = 0;
  for (Index k = 0; k < truth.cols(); ++k) {
    const double strength = vortex.strength(truth.col(k));
    off += std::abs(vortex.strength(s.x.col(k)) - strength);
    for (int c = 0; c < 2; ++c) {
      auto part = small.col(k).segment(c * cells, cells);
      part.array() -= part.mean();
      for (Index a = 0; a < cells; ++a)
        part(a) -= strength * vortex(c, a / n, a % n);
    }
  }
  values(kError) = mean_length(s.x - truth);
  values(kVortex) = off / double(truth.cols());
  values(kLarge) = mean_length(small);
}

}  // namespace

double mean_length(BatchIn<double> field) {
  const Index cells = field.rows() / 2;
  return (field.topRows(cells).array().square() +
          field.bottomRows(cells).array().square())
      .sqrt()
      .mean();
}

Metrics metrics() {
  return {.name = "marker_flow",
          .rows = {"error", "vortex", "large"},
          .evaluate = evaluate};
}

}  // namespace physinv::fluid_case
