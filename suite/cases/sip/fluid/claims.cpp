// What App. B.4 of the SIP paper says of the fluid, and the ranges of
// independent programs. Errors of v0 are mean distances at the cells.
#include <cmath>
#include <optional>
#include <vector>

#include "problems/marker_flow/marker_flow.h"
#include "suite/cases/sip/fluid/fluid.h"
#include "suite/cases/sip/fluid/metrics.h"
#include "suite/evidence/training.h"
#include "suite/harness/registry.h"

namespace physinv::fluid_case {
namespace {

RowOfCurve metric(MetricRow row) { return {"metrics", row}; }
RunValue error_after(Index updates) {
  return value_after(metric(kError), updates);
}
RunValue end() { return last_of(metric(kError)); }
/// Share of the first value that is left at the end.
RunValue error_left() { return over(end(), error_after(0)); }
/// The loss with its floor, as the authors have it.
RunValue with_floor(RunValue loss) {
  return [=](const Run& run) -> std::optional<double> {
    const auto value = loss(run);
    if (!value) return {};
    const MarkerFlowOptions o;
    return *value + FrequencyLoss(kCells, o.falloff, o.threshold).floor();
  };
}
RunValue loss_left() {
  return over(with_floor(last_loss()), with_floor(first_loss()));
}
Quantity worst_ratio(const char* a, const char* b, const RunValue& value) {
  return also_asks(highest({a}, over(value, beside({b}, value))), {{b}});
}

/// Share of the recorded examples whose vortex is nearer to the truth's than
/// none is.
RunValue vortices_found() {
  return [](const Run& run) -> std::optional<double> {
    const Batch<double>&x = run.stage->x, &truth = run.record->data.x;
    const Vortex vortex{.grid = {.cells = kCells}};
    if (x.cols() == 0 || truth.cols() < x.cols()) return {};
    Index found = 0;
    for (Index k = 0; k < x.cols(); ++k) {
      const double wanted = vortex.strength(truth.col(k));
      found += std::abs(vortex.strength(x.col(k)) - wanted) < std::abs(wanted);
    }
    return double(found) / double(x.cols());
  };
}

/// sum m^2 at the end over that at the start.
RunValue marker_left() {
  return [](const Run& run) -> std::optional<double> {
    const auto& data = run.record->data;
    if (data.given.size() == 0) return {};
    return data.y.squaredNorm() / data.given.squaredNorm();
  };
}

const std::vector<Claim> kInverse = {
    {.id = "P6",
     .origin = Origin::paper,
     .where = "App. B.4",
     .from = "quick",
     .says = "Reverse simulation yields the strength of the vortex",
     .conditions = {above("share of examples nearer than none",
                          lowest({"inverse"}, vortices_found()),
                          0.5)},
     .note = "The estimate fed with itself ten times, from no velocity."},
    {.id = "P7",
     .origin = Origin::paper,
     .where = "App. B.4",
     .from = "quick",
     .says = "Advection diffuses the marker visibly",
     .conditions = {
         below("sum m^2 left", highest({"inverse"}, marker_left()), 0.95)}}};

const std::vector<Claim> kTrained = {
    {.id = "P1",
     .origin = Origin::paper,
     .where = "App. B.4",
     .from = "paper",
     .says = "SIP finds a much better v0 than the regular gradient",
     .conditions = {below("error over Adam's, worst seed",
                          worst_ratio("sip", "adam", end()),
                          1)}},
    {.id = "P2",
     .origin = Origin::paper,
     .where = "Fig. 14",
     .from = "paper",
     .says = "The difference is especially clear in v0, not in the markers",
     .conditions = {above(
         "SIP's ratio of loss to error over Adam's, worst seed",
         also_asks(lowest({"sip"},
                          over(over(with_floor(last_loss()), end()),
                               beside({"adam"},
                                      over(with_floor(last_loss()), end())))),
                   {{"adam"}}),
         1)}},
    {.id = "P3",
     .origin = Origin::paper,
     .where = "App. B.4",
     .from = "quick",
     .says = "That small scales are ignored limits SIP's accuracy",
     .conditions = {
         at_least("error over that of v0 without them",
                  lowest({"sip-b16"}, over(end(), last_of(metric(kLarge)))),
                  1)}}};

const std::vector<Claim> kUndecided = {
    {.id = "P4",
     .origin = Origin::paper,
     .where = "App. B.4",
     .from = "paper",
     .says = "Trained for extremely long, the gradient could win",
     .conditions = {},
     .note = "No profile trains that long."},
    {.id = "P5",
     .origin = Origin::paper,
     .where = "App. B.4",
     .from = "paper",
     .says = "L-BFGS-B is no better than the gradient and overshoots high "
             "frequencies",
     .conditions = {},
     .note = "Targets found by L-BFGS-B are not run."}};

const std::vector<Claim> kRanges = {
    {.id = "A1",
     .from = "quick",
     .says = "Error of v0 over Adam's, batches of 16",
     .conditions = {at_most(
                        "after 150",
                        worst_ratio("sip-b16", "adam-b16", error_after(150)),
                        0.9),
                    at_most(
                        "after 300",
                        worst_ratio("sip-b16", "adam-b16", error_after(300)),
                        0.8)}},
    {.id = "A2",
     .from = "quick",
     .says = "Adam fits the markers and not v0, batches of 16",
     .conditions = {
         below("its loss, share left", highest({"adam-b16"}, loss_left()), 0.5),
         above("its error of v0, share left",
               lowest({"adam-b16"}, error_left()),
               0.75)}}};

const bool kClaims = register_claims(kCode.experiment, kTrained) &&
                     register_claims(kCode.experiment, kUndecided) &&
                     register_claims(kCode.experiment, kInverse) &&
                     register_claims(kCode.experiment, kRanges) &&
                     register_claims(kTimed.experiment, kInverse);

}  // namespace
}  // namespace physinv::fluid_case
