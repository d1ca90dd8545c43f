// Values of a run that claims.md names.
#include "suite/cases/common/claims.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "problems/marker_flow/marker_flow.h"
#include "suite/cases/sip/fluid/fluid.h"
#include "suite/cases/sip/fluid/metrics.h"
#include "suite/evidence/training.h"

namespace physinv::fluid_case {
namespace {

/// The loss with its floor, as the authors have it.
RunValue with_floor(RunValue loss) {
  return [=](const Run& run) -> std::optional<double> {
    const auto value = loss(run);
    if (!value) return {};
    const MarkerFlowOptions o;
    return *value + FrequencyLoss(kCells, o.falloff, o.threshold).floor();
  };
}
/// Share of the recorded examples whose vortex is nearer to the truth's than
/// none is.
std::optional<double> vortices_found(const Run& run) {
  const Batch<double>&x = run.stage->x, &truth = run.record->data.x;
  const Vortex vortex{.grid = {.cells = kCells}};
  if (x.cols() == 0 || truth.cols() < x.cols()) return {};
  Index found = 0;
  for (Index k = 0; k < x.cols(); ++k) {
    const double wanted = vortex.strength(truth.col(k));
    found += std::abs(vortex.strength(x.col(k)) - wanted) < std::abs(wanted);
  }
  return double(found) / double(x.cols());
}

/// |x - x*| at the cells of the recorded examples, their mean.
std::optional<double> recorded_error(const Run& run) {
  const Batch<double>& x = run.stage->x;
  if (x.cols() == 0) return {};
  return mean_length(x - run.record->data.x.leftCols(x.cols()));
}

/// Energy of what each cell differs in from the mean of its four neighbours.
double fine_energy(BatchIn<double> fields) {
  const auto at = [](Index a, Index b) {
    return (a + kCells) % kCells * kCells + (b + kCells) % kCells;
  };
  double energy = 0;
  const Batch<double> planes =
      fields.reshaped(kCells * kCells, 2 * fields.cols());
  for (Index p = 0; p < planes.cols(); ++p) {
    const auto plane = planes.col(p);
    for (Index a = 0; a < kCells; ++a)
      for (Index b = 0; b < kCells; ++b) {
        const double around = plane(at(a - 1, b)) + plane(at(a + 1, b)) +
                              plane(at(a, b - 1)) + plane(at(a, b + 1));
        const double apart = plane(at(a, b)) - around / 4;
        energy += apart * apart;
      }
  }
  return energy;
}
/// That of the recorded estimates over that of the truth.
std::optional<double> fine_scales(const Run& run) {
  const Batch<double>& x = run.stage->x;
  if (x.cols() == 0) return {};
  return fine_energy(x) / fine_energy(run.record->data.x.leftCols(x.cols()));
}

/// Updates from which on Adam's error is below SIP's of the same seed; infinite
/// if it is not in the end.
std::optional<double> overtakes(const Run& adam) {
  const auto sip = adam.beside({"sip"});
  if (!sip) return {};
  const CurveRow ours{*adam.stage, "metrics", kError},
      other{*sip->stage, "metrics", kError};
  double since = std::numeric_limits<double>::infinity();
  for (Index k = std::min(ours.points(), other.points()); k-- > 0;) {
    if (!(ours(k) < other(k))) break;
    since = ours.updates(k);
  }
  return since;
}

/// sum m^2 at the end over that at the start.
std::optional<double> marker_left(const Run& run) {
  const auto& data = run.record->data;
  if (data.given.size() == 0) return {};
  return data.y.squaredNorm() / data.given.squaredNorm();
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("error", metric(kError));
  names.set("large_scales", metric(kLarge));
  names.add("with_floor", with_floor);
  names.set("vortices_found", vortices_found);
  names.set("recorded_error", recorded_error);
  names.set("fine_scales", fine_scales);
  names.set("overtakes_sip", overtakes);
  names.set("marker_left", marker_left);
  add_claims_of_folder(r, "sip/fluid", names);
}

}  // namespace physinv::fluid_case
