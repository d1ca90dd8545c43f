// What App. B.2 of the SIP paper says of Poisson's equation, and the ranges of
// independent programs. Errors are sums of |x - x*| over the cells.
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "suite/cases/sip/poisson/metrics.h"
#include "suite/cases/sip/poisson/poisson.h"
#include "suite/evidence/training.h"
#include "suite/harness/networks.h"
#include "suite/harness/registry.h"
#include "suite/results/crowded.h"

namespace physinv::poisson {
namespace {

RunValue end() { return last_of(metric(kError)); }
/// After 2000 updates, which all methods have.
RunValue after_study() {
  return if_ran(2000, value_after(metric(kError), 2000));
}
/// Of the error of an estimate of zero.
RunValue left(const RunValue& error = end()) {
  return over(error, value_after(metric(kOfZero), 0));
}
/// Of that of the network as it was drawn.
RunValue over_start(const RunValue& error) {
  return over(error, value_after(metric(kError), 0));
}
/// The first trains with every seed; the second, with ten times its rate, does
/// not, or ends worse.
std::vector<Condition> largest_rate(const std::string& label,
                                    const Select& of,
                                    const Select& tenfold,
                                    const RunValue& error) {
  const RunValue value = or_infinite(error);
  return {below(label + ", error over the start's, worst seed",
                highest(of, over_start(value)),
                1),
          above("ten times its rate, error over that, worst seed",
                worst_ratio(tenfold, of, value),
                1),
          reported("median seed", median_ratio(tenfold, of, value))};
}

std::vector<Condition> adahessian(const std::string& batch,
                                  const RunValue& error) {
  const RunValue value = or_infinite(error);
  const auto of = [=](const std::string& variant) {
    return median({"adahessian" + variant + batch}, value);
  };
  return {at_most("1e-6, error over the best of 1e-7, 1e-6, 1e-5",
                  ratio(of(""), least({of("-lr7"), of(""), of("-lr5")})),
                  1.2),
          above("1e-4, error over the start's",
                median({"adahessian-lr4" + batch}, over_start(value)),
                1),
          below("power 0.5, error over that of power 1",
                ratio(of(""), of("-power1")),
                1)};
}

/// At the last measured point up to there.
double error_by(const Run& run, double seconds) {
  const auto& all = run.stage->curve.seconds;
  const auto after = std::upper_bound(all.begin(), all.end(), seconds);
  return CurveRow{*run.stage, "metrics", kError}(
      static_cast<Index>(after - all.begin()) - 1);
}
/// Error over that of another run when the shorter one ends; of runs that had
/// their cores to themselves.
RunValue over_at_equal_time(const Select& other) {
  return [=](const Run& run) -> std::optional<double> {
    const auto rival = run.beside(other);
    if (!rival || is_crowded(*run.stage) || is_crowded(*rival->stage))
      return {};
    const double seconds = std::min(run.stage->curve.seconds.back(),
                                    rival->stage->curve.seconds.back());
    return error_by(run, seconds) / error_by(*rival, seconds);
  };
}
Quantity wide_over_narrow(const char* method, Index updates = 0) {
  const Select narrow = Select{method}.in(kNarrow.experiment);
  return depends_on(
      median({method},
             if_ran(static_cast<double>(updates), over_at_equal_time(narrow))),
      {narrow});
}
constexpr char kWideOverNarrow[] =
    "error over that of width 16 at equal time, median";
constexpr Index kWhole = 10'000;  ///< updates of the wide operator

Quantity hessian_free_after(Index updates) {
  return median({"hf"}, value_after(metric(kError), updates));
}

Quantity over_sip(const char* method) {
  return ratio_of_medians({method}, {"sip"}, after_study());
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
     .where = "App. B.2",
     .from = "quick",
     .says = "It converges extremely slowly",
     .conditions = {above("error of x left after 300 steps",
                          median({"gd"}, direct_error()),
                          0.5)}},
    {.id = "P2b",
     .where = "App. B.2",
     .from = "quick",
     .says = "So does Adam, which stands larger rates",
     .conditions =
         {above("error of x left after 300 steps, best of 1e-3, 1e-2, 1e-1",
                least({median({"direct-adam-lr3"}, direct_error()),
                       median({"direct-adam-lr2"}, direct_error()),
                       median({"direct-adam-lr1"}, direct_error())}),
                0.5),
          below("1e-3, loss at the end over the first",
                highest({"direct-adam-lr3"}, growth()),
                1)},
     .cause = depends(
         "Adam's rate is not printed: with 1e-1 a quarter of the error is left "
         "after 300 steps, with 1e-3 more than half",
         {above("error of x left after 300 steps, 1e-3",
                median({"direct-adam-lr3"}, direct_error()),
                0.5)})},
    {.id = "P3",
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
     .where = "App. B.2, Fig. 15",
     .from = "quick",
     .says = "An update of SIP takes no longer than one with the gradient",
     .conditions =
         {of_stages(at_most(
              "CPU time over Adam's, median",
              median_ratio({"sip-b8"}, {"adam-b8"}, seconds_per_update()),
              1.1)),
          of_stages(below(
              "a direct step of inverse physics over one of gradient descent",
              median_ratio(
                  {"inverse-physics-300"}, {"gd"}, seconds_per_update()),
              1))},
     .gates = false},
    {.id = "P5",
     .where = "App. B.2",
     .says = "The rates are the largest that train consistently, after 2000 "
             "updates",
     .conditions =
         joined({largest_rate("SGD", {"sgd"}, {"sgd-10x"}, after_study()),
                 largest_rate("Adam", {"adam"}, {"adam-10x"}, after_study()),
                 largest_rate("SIP", {"sip"}, {"sip-10x"}, after_study())}),
     .cause = not_run("1.4 CPU-hours for one seed: 2000 updates at the rates "
                      "and ten times them")},
    {.id = "A5",
     .from = "standard",
     .says = "Batches of 8, 200 updates: SGD's rate is the largest, 16 times "
             "the printed one for sums over a sixteenth of the batch",
     .conditions = largest_rate(
         "SGD", {"sgd-16x-b8"}, {"sgd-160x-b8"}, late_training_error())},
    {.id = "P6",
     .where = "App. B.2",
     .says = "AdaHessian does best with 1e-6 and a Hessian power of 0.5 and "
             "diverges with 1e-4, after 500 updates",
     .conditions = adahessian("", value_after(metric(kError), 500)),
     .cause =
         not_run("1e-4 diverges, as printed (one seed); 15 CPU-minutes for "
                 "each of 1e-6 with powers of 0.5 and 1")},
    {.id = "A6",
     .from = "standard",
     .says = "The same with batches of 8, 150 updates",
     .conditions = adahessian("-b8", late_training_error()),
     .cause = fails(
         "with batches of 8, after 150 updates, 1e-6 ends 27 % above 1e-5 and "
         "1e-4 at 0.94 of the start: sums over a sixteenth of the paper's "
         "batch make smaller steps")},
    {.id = "P10",
     .where = "App. B.2",
     .from = "quick",
     .says = "The networks' numbers of parameters",
     .conditions =
         {equals("U-net", parameters(kPlane.experiment), 37'697),
          equals("operator, a complex one taken as one, over 1,188,353",
                 ratio(parameters_complex_once(kFno.experiment), 1'188'353),
                 1),
          equals("its real numbers over 2,368,001",
                 ratio(parameters(kFno.experiment), 2'368'001),
                 1)}},
    {.id = "P8",
     .where = "Fig. 9",
     .says = "SIP ends below Adam, every seed",
     .conditions =
         below_on_every_seed("error over Adam's", {"sip"}, {"adam"}, end()),
     .cause = not_run("3 CPU-hours for a second seed: 12,000 updates of both "
                      "methods with batches of 128")},
    {.id = "P7",
     .where = "App. B.2",
     .says = "Hessian-free reaches an error of 900 in fewer than six updates",
     .conditions = {below("updates to an error of 900",
                          median({"hf"}, first_below(900, metric(kError))),
                          6),
                    reported("error after five", hessian_free_after(5)),
                    reported("after six", hessian_free_after(6))},
     .note = "A sum over 64 x 64 cells; over the paper's 80 x 60 it is larger.",
     .cause = differs(
         "after five updates the error is 1,037 and after six 1,014, printed "
         "are 900; it starts at 3,949 (one seed)",
         {below("error after five over the first",
                ratio(hessian_free_after(5), hessian_free_after(0)),
                1 / 3.0)})},
    {.id = "A3",
     .says = "Batches of 8, the last 30 of 120 updates",
     .conditions =
         {at_most("SIP over Adam, worst seed",
                  worst_ratio({"sip-b8"}, {"adam-b8"}, late_training_error()),
                  0.65),
          at_most("SIP", highest({"sip-b8"}, late_training_error()), 1100),
          within(
              "Adam", median({"adam-b8"}, late_training_error()), 1500, 2300)}},
    {.id = "A4",
     .from = "standard",
     .says = "Batches of 128, after 2000 updates",
     .conditions = {at_least("Adam over SIP", over_sip("adam"), 2),
                    at_least("SGD over SIP", over_sip("sgd"), 2),
                    above("SGD, error left",
                          median({"sgd"}, left(after_study())),
                          0.6)},
     .cause = fails("after 2000 updates SGD has 45 % of its first error left, "
                    "more than 60 % "
                    "was read from the paper's figure")},
    {.id = "A4b",
     .from = "paper",
     .says = "AdaHessian, the same",
     .conditions = {at_least("over SIP", over_sip("adahessian"), 2),
                    above("error left",
                          median({"adahessian"}, left(after_study())),
                          0.6)},
     .cause = not_run("an hour of CPU: 2000 updates of AdaHessian with batches "
                      "of 128")}};

const std::vector<Claim> kOnSmall = {
    {.id = "A3",
     .says = "Batches of 8 on a small grid",
     .conditions =
         {at_most("SIP over Adam after 160 updates",
                  worst_ratio({"sip-b8"}, {"adam-b8"}, late_training_error()),
                  0.7),
          above("AdaHessian, error left after 70",
                median({"adahessian-b8"}, left()),
                0.8),
          above("SGD, after 170", median({"sgd-b8"}, left()), 0.85),
          below("Hessian-free, after 2", median({"hf-40-b8"}, left()), 0.8)}},
    {.id = "A5",
     .from = "standard",
     .says = "Batches of 8 on a small grid, 600 updates: 1e-3 is the largest "
             "rate that trains consistently",
     .conditions = joined(
         {largest_rate(
              "Adam", {"adam-long-b8"}, {"adam-10x-b8"}, late_training_error()),
          largest_rate("SIP",
                       {"sip-long-b8"},
                       {"sip-10x-b8"},
                       late_training_error())})}};

const std::vector<Claim> kOperators = {
    {.id = "P9",
     .where = "App. B.2",
     .says = "Smaller operators do worse in the same time",
     .conditions = {at_most(
                        kWideOverNarrow, wide_over_narrow("fno", kWhole), 1),
                    reported("as far as they ran", wide_over_narrow("fno"))},
     .cause = not_run("8 CPU-hours for one seed: 10,000 updates of the wide "
                      "operator, 20,000 of the narrow one; after 500 the wide "
                      "one is 11 % above at equal time"),
     .gates = false},
    {.id = "A9",
     .from = "standard",
     .says = "The same with batches of 8, 100 updates",
     .conditions = {at_most(
         kWideOverNarrow, wide_over_narrow("fno-long-b8"), 1)},
     .cause = fails("the wider operator is 8 % above the narrower one at equal "
                    "time, on a machine that was shared"),
     .gates = false}};

}  // namespace

void add_claims(Registry& r) {
  r.add_claims(kPlane.experiment, kDirect);
  r.add_claims(kPlane.experiment, kTrained);
  r.add_claims(kPaper.experiment, kDirect);
  r.add_claims(kSmall.experiment, kOnSmall);
  r.add_claims(kFno.experiment, kOperators);
}

}  // namespace physinv::poisson
