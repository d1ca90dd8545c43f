// What App. B.2 of the SIP paper says of Poisson's equation, and the ranges of
// independent programs. Errors are sums of |x - x*| over the cells.
#include <cmath>
#include <optional>
#include <vector>

#include "suite/cases/sip/poisson/metrics.h"
#include "suite/cases/sip/poisson/poisson.h"
#include "suite/evidence/training.h"
#include "suite/harness/registry.h"

namespace physinv::poisson {
namespace {

RunValue end() { return last_of({"metrics", kError}); }
/// After 2000 updates, which all methods have.
RunValue after_study() { return value_after({"metrics", kError}, 2000); }
/// Of the error of an estimate of zero.
RunValue left(const RunValue& error = end()) {
  return over(error, value_after({"metrics", kOfZero}, 0));
}
/// Mean over the batches of the last quarter of the updates.
RunValue tail() {
  return [](const Run& run) -> std::optional<double> {
    const auto found = run.stage->arrays.find("late_error");
    if (found == run.stage->arrays.end()) return {};
    return found->second(0, 0);
  };
}
Quantity worst_ratio(const char* a, const char* b, const RunValue& value) {
  return also_asks(highest({a}, over(value, beside({b}, value))), {{b}});
}

Quantity over_sip(const char* method) {
  return ratio(median({method}, after_study()), median({"sip"}, after_study()));
}

/// Error of direct estimates over that of zero, mean over the examples.
RunValue direct_error(std::optional<Precision> precision = {}) {
  return [=](const Run& run) -> std::optional<double> {
    const Batch<double>&x = run.stage->x, &truth = run.record->data.x;
    if (precision && run.record->info.precision != *precision) return {};
    if (x.cols() == 0 || truth.cols() != x.cols()) return {};
    return (x - truth).lpNorm<1>() / truth.lpNorm<1>();
  };
}
/// Mean loss at the end over that of the start.
RunValue growth() {
  return [](const Run& run) -> std::optional<double> {
    const Batch<double>& loss = run.stage->curve.loss;
    if (loss.cols() < 2) return {};
    return loss.rightCols(1).mean() / loss.col(0).mean();
  };
}
/// Largest loss over the one before, along the curve of every example.
RunValue steepest_rise() {
  return [](const Run& run) -> std::optional<double> {
    const Batch<double>& loss = run.stage->curve.loss;
    if (loss.cols() < 2) return {};
    return (loss.rightCols(loss.cols() - 1).array() /
            loss.leftCols(loss.cols() - 1).array())
        .maxCoeff();
  };
}

const std::vector<Claim> kDirect = {
    {.id = "P1",
     .origin = Origin::paper,
     .where = "App. B.2",
     .from = "quick",
     .says = "Gradient descent on single examples needs a rate of at most 2e-5",
     .conditions = {below("loss over the one before, largest, 2e-5",
                          highest({"gd"}, steepest_rise()),
                          1),
                    above("5e-5, loss at the end over the first",
                          lowest({"gd-5e-5"}, growth()),
                          1e3)}},
    {.id = "P2",
     .origin = Origin::paper,
     .where = "App. B.2",
     .from = "quick",
     .says = "It converges extremely slowly",
     .conditions = {above("error of x left after 300 steps",
                          median({"gd"}, direct_error()),
                          0.5)}},
    {.id = "P3",
     .origin = Origin::paper,
     .where = "App. B.2",
     .from = "quick",
     .says = "One step of inverse physics points directly to the solution",
     .conditions =
         {below("error of x left, double",
                highest({"inverse-physics"}, direct_error(Precision::f64)),
                1e-10),
          below("float",
                highest({"inverse-physics"}, direct_error(Precision::f32)),
                1e-3)}},
};

const std::vector<Claim> kTrained = {
    {.id = "P4",
     .origin = Origin::paper,
     .where = "App. B.2, Fig. 15",
     .from = "quick",
     .says = "An update of SIP takes no longer than one with the gradient",
     .conditions = {at_most(
         "time over Adam's, median",
         median_ratio({"sip-b8"}, {"adam-b8"}, seconds_per_update()),
         1.1)},
     .gates = false},
    {.id = "P8",
     .origin = Origin::paper,
     .where = "Fig. 9",
     .from = "paper",
     .says = "SIP ends below Adam, every seed",
     .conditions = {below("error over Adam's, worst seed",
                          worst_ratio("sip", "adam", end()),
                          1)}},
    {.id = "P7",
     .origin = Origin::paper,
     .where = "App. B.2",
     .from = "paper",
     .says = "Hessian-free reaches an error of 900 in fewer than six updates",
     .conditions = {within(
         "error after six", median({"hf"}, end()), 600, 1350)}},
    {.id = "A3",
     .from = "quick",
     .says = "Batches of 8, the last 30 of 120 updates",
     .conditions = {at_most("SIP over Adam, worst seed",
                            worst_ratio("sip-b8", "adam-b8", tail()),
                            0.65),
                    at_most("SIP", highest({"sip-b8"}, tail()), 1100),
                    within("Adam", median({"adam-b8"}, tail()), 1500, 2300)}},
    {.id = "A4",
     .from = "paper",
     .says = "Batches of 128, after 2000 updates",
     .conditions = {at_least("Adam over SIP", over_sip("adam"), 2),
                    at_least("SGD over SIP", over_sip("sgd"), 2),
                    above("SGD, error left",
                          median({"sgd"}, left(after_study())),
                          0.6)}},
    {.id = "A4b",
     .from = "paper",
     .says = "AdaHessian, the same",
     .conditions = {
         at_least("over SIP", over_sip("adahessian"), 2),
         above(
             "error left", median({"adahessian"}, left(after_study())), 0.6)}}};

const std::vector<Claim> kOnSmall = {
    {.id = "A3",
     .from = "quick",
     .says = "Batches of 8 on a small grid",
     .conditions = {
         at_most("SIP over Adam after 160 updates",
                 worst_ratio("sip-b8", "adam-b8", tail()),
                 0.7),
         above("AdaHessian, error left after 70",
               median({"adahessian-b8"}, left()),
               0.8),
         above("SGD, after 170", median({"sgd-b8"}, left()), 0.85),
         below("Hessian-free, after 2", median({"hf-40-b8"}, left()), 0.8)}}};

const bool kClaims = register_claims(kPlane.experiment, kDirect) &&
                     register_claims(kPlane.experiment, kTrained) &&
                     register_claims(kPaper.experiment, kDirect) &&
                     register_claims(kSmall.experiment, kOnSmall);

}  // namespace
}  // namespace physinv::poisson
