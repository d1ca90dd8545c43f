// HIG paper, Secs. 2.1, 2.2, A.2. The paper prints no length of these runs:
// its sentences are judged at the end of ours, 400 epochs or more.
#include <algorithm>
#include <cmath>
#include <vector>

#include "suite/cases/hig/toy/toy.h"
#include "suite/core/math.h"
#include "suite/evidence/curve_shape.h"
#include "suite/harness/registry.h"
#include "suite/store/record.h"

namespace physinv::toy {
namespace {

constexpr Index kEnd = 400 * kUpdatesPerEpoch;
/// Medians of fewer seeds scatter too much for their ratio to be judged.
constexpr Index kSeeds = 24;
constexpr const char* kWell = kGammas[0].experiment;

// ---- numbers of a run -------------------------------------------------------

/// How many times the start is the end.
RunValue decrease() { return over(first_loss(), last_loss()); }
RunValue decrease_of_last_half() {
  return over(loss_at_share(0.5), last_loss());
}

/// What the second component has lost of its loss once the first one's is down
/// to a third; empty if it never is.
std::optional<double> second_lost(const Run& run) {
  const CurveRow first{*run.stage, "metrics", kFirstLoss},
      second{*run.stage, "metrics", kSecondLoss};
  for (Index k = 0; k < first.points(); ++k)
    if (first(k) <= first(0) / 3) return 1 - second(k) / second(0);
  return {};
}

/// Distance over length of the point's path in the last half of the updates.
std::optional<double> straightness(const Run& run) {
  const CurveRow x{*run.stage, "metrics", kPathFirst},
      y{*run.stage, "metrics", kPathSecond};
  const Index last = x.points() - 1;
  Index from = 0;
  while (x.updates(from) < x.updates(last) / 2) ++from;
  double path = 0;
  for (Index k = from; k < last; ++k)
    path += math::hypot(x(k + 1) - x(k), y(k + 1) - y(k));
  if (!(path > 0)) return {};
  return math::hypot(x(last) - x(from), y(last) - y(from)) / path;
}

// ---- of all seeds -----------------------------------------------------------

Quantity after(const char* method) { return median_after({method}, kEnd); }
/// Of medians of enough seeds.
Quantity compared(const char* a, const char* b) {
  return from_at_least(kSeeds, ratio(after(a), after(b)));
}
Quantity price(const char* method) {
  const Select well = Select{method}.in(kWell);
  return ratio(after(method), median_after(well, kEnd));
}

/// The largest median along the curves.
Quantity highest_median(const char* method) {
  return highest_along({method}, 0, [=](double updates) {
    return median_after({method}, updates);
  });
}

Quantity most_diverged() {
  std::vector<Quantity> counts;
  for (const char* method : {"adam", "gn", "hig", "sgd", "gn_tau6"})
    counts.push_back(
        count({method}, diverged(), [](double v) { return v > 0; }));
  return most(counts);
}

Quantity saturated_share(Select select) {
  return share_of_examples(std::move(select), last_deviations, is_saturated);
}
/// Of shares, by the deviations of the seeds' own.
Quantity errors_apart(const char* a, const char* b) {
  const Quantity x = saturated_share({a}), y = saturated_share({b});
  return {[=](const Evidence& e) {
            const Measured u = x(e), v = y(e);
            if (!u.value || !v.value) return u.value ? v : u;
            const double error =
                math::hypot(u.spread.value_or(0), v.spread.value_or(0)) /
                std::sqrt(static_cast<double>(std::min(u.runs, v.runs)));
            return Measured{.value = (*u.value - *v.value) / error,
                            .runs = std::min(u.runs, v.runs)};
          },
          {{a}, {b}}};
}
Quantity seeds_with_saturation(const char* method) {
  return share({method}, saturated_neurons(), [](double neurons) {
    return neurons > 0;
  });
}

// ---- the suite's own ranges -------------------------------------------------

const Claim kGaussNewtonSaturates{
    .id = "A5",
    .from = "standard",
    .says = "GN with HIG's cut saturates neurons and ends above HIG",
    .conditions = {
        above("saturated neurons", saturated_share({"gn_tau6"}), 0.25),
        above("median loss over HIG's", compared("gn_tau6", "hig"), 5)}};

const Claim kOvershoot{
    .id = "A6",
    .says = "The first updates overshoot, and all runs come back",
    .conditions = {
        above("highest median of GN", highest_median("gn"), 3),
        below("of HIG", highest_median("hig"), 5),
        at_most(
            "runs that are not finite, most of a method", most_diverged(), 0)}};

const std::vector<Claim> kWellConditioned = {
    {.id = "A1",
     .says = "In 1600 updates GN and HIG lower the loss by three orders, Adam "
             "by two",
     .conditions = {below("GN", after("gn"), 2e-3),
                    below("HIG", after("hig"), 1e-3),
                    within("Adam", after("adam"), 1e-3, 3e-2)}},
    {.id = "A1b",
     .from = "standard",
     .says = "HIG ends as low as GN",
     .conditions = {at_most("HIG over GN", compared("hig", "gn"), 1.5)}},
    kGaussNewtonSaturates,
    kOvershoot,
    {.id = "P1",
     .where = "Sec. 2.1, Fig. 1a",
     .from = "standard",
     .says = "Adam and GN lower the loss by about three orders of magnitude",
     .conditions = {at_least("Adam, start over end, median",
                             median({"adam"}, decrease()),
                             316),
                    at_least("GN, start over end, median",
                             median({"gn"}, decrease()),
                             316)},
     .note = "About three orders: 2.5 or more.",
     .cause =
         differs("in the median Adam lowers the loss by 2.0 decades, about "
                 "three are printed; the best seeds of both do by 2.5",
                 {at_least("Adam, start over end, best seed",
                           highest({"adam"}, decrease()),
                           316),
                  at_least("GN, start over end, best seed",
                           highest({"gn"}, decrease()),
                           316)})},
    {.id = "P2",
     .where = "Sec. 2.1, Fig. 1a",
     .from = "standard",
     .says = "Adam and GN behave similarly",
     .conditions = {within(
         "Adam's end over GN's, medians of 24",
         from_at_least(kSeeds, ratio_of_medians({"adam"}, {"gn"}, last_loss())),
         0.1,
         10)}},
    {.id = "P3",
     .where = "Sec. 2.2, Fig. 1a",
     .from = "standard",
     .says = "HIG minimise the objective as well as Adam and GN",
     .conditions = {at_most(
         "HIG's end over the better of both",
         ratio(median_at_end({"hig"}),
               least({median_at_end({"adam"}), median_at_end({"gn"})})),
         3.2)}},
    {.id = "P8",
     .where = "Sec. 2.1, Fig. 1a",
     .from = "standard",
     .says = "With Adam and GN all neurons process information",
     .conditions = {below("Adam, seeds with a saturated neuron",
                          seeds_with_saturation("adam"),
                          0.5),
                    below("GN, seeds with a saturated neuron",
                          seeds_with_saturation("gn"),
                          0.5)}},
    {.id = "P11",
     .where = "App. A.2",
     .from = "standard",
     .says = "After a first phase GN's path of a point is linear",
     .conditions = {at_least(
         "distance over length, last half", median({"gn"}, straightness), 0.9)},
     .note = "Between the recorded points of the path of x = 0.35."},
};

const RunValue kSecondAfterTwenty =
    value_after(metric(kSecondLoss), 20 * kUpdatesPerEpoch);

const std::vector<Claim> kIllConditioned = {
    {.id = "A2",
     .from = "standard",
     .says = "HIG ends low on all seeds, Adam and GN on some of them",
     .conditions = {within("HIG", after("hig"), 3.1e-3, 1.2e-2),
                    within("Adam", after("adam"), 3.2e-3, 6.3e-2),
                    within("GN", after("gn"), 1.6e-3, 0.17),
                    above("Adam over HIG", compared("adam", "hig"), 1),
                    reported("GN over HIG", compared("gn", "hig")),
                    reported("worst HIG", highest({"hig"}, loss_after(kEnd)))},
     .note =
         "Ranges: lowest to highest of 24 seeds, which hold 80 % of all "
         "seeds with 95 % confidence. GN ends either below 0.009, 11 of 24, "
         "or above 0.017: which, the median of a dozen leaves to chance."},
    {.id = "A3",
     .says = "After 20 epochs Adam has not touched the second component; HIG "
             "has",
     .conditions = {above("Adam's second component",
                          median({"adam"}, kSecondAfterTwenty),
                          0.22),
                    above("Adam's",
                          median({"adam"}, kSecondAfterTwenty),
                          median({"hig"}, kSecondAfterTwenty))}},
    {.id = "A4",
     .from = "standard",
     .says = "What gamma = 0.01 costs against gamma = 1: HIG more than Adam, "
             "which is worse from the outset",
     .conditions = {within("HIG", price("hig"), 5, 60),
                    above("HIG's factor", price("hig"), price("adam"))}},
    kGaussNewtonSaturates,
    kOvershoot,
    {.id = "P4",
     .where = "Sec. 2.1, Fig. 1b",
     .from = "standard",
     .says = "Adam and GN fail to minimise the objective beyond a certain "
             "point",
     .conditions = {below("Adam, fall in the last half",
                          median({"adam"}, decrease_of_last_half()),
                          2),
                    below("GN, fall in the last half",
                          median({"gn"}, decrease_of_last_half()),
                          2),
                    above("Adam's end over that of gamma = 1",
                          ratio_of_medians(
                              {"adam"}, Select{"adam"}.in(kWell), last_loss()),
                          3.2),
                    above("GN's end over that of gamma = 1",
                          ratio_of_medians(
                              {"gn"}, Select{"gn"}.in(kWell), last_loss()),
                          3.2)}},
    {.id = "P5",
     .where = "Sec. 2.2, Fig. 1b",
     .from = "standard",
     .says = "HIG achieve a better result than Adam and GN",
     .conditions =
         {above("Adam's end over HIG's, medians of 24",
                from_at_least(kSeeds,
                              ratio_of_medians({"adam"}, {"hig"}, last_loss())),
                1),
          above("GN's end over HIG's, medians of 24",
                from_at_least(kSeeds,
                              ratio_of_medians({"gn"}, {"hig"}, last_loss())),
                1),
          reported("Adam over HIG, best seeds",
                   ratio(lowest_at_end({"adam"}), lowest_at_end({"hig"}))),
          reported("GN over HIG, best seeds",
                   ratio(lowest_at_end({"gn"}), lowest_at_end({"hig"})))}},
    {.id = "P6",
     .where = "Sec. 2.1, Fig. 1b",
     .from = "standard",
     .says = "Adam's updates neglect the second component",
     .conditions = {below("lost of its loss when the first has lost 2/3",
                          median({"adam"}, second_lost),
                          2.0 / 3)}},
    {.id = "P7",
     .where = "Sec. 2.2, Fig. 1b",
     .from = "standard",
     .says = "HIG progress along the second component",
     .conditions = {below("HIG, end over start",
                          median({"hig"}, share_left(metric(kSecondLoss))),
                          0.5),
                    below("HIG's end over Adam's",
                          ratio_of_medians(
                              {"hig"}, {"adam"}, last_of(metric(kSecondLoss))),
                          1)}},
    {.id = "P9",
     .where = "Sec. 2.1, Fig. 1b",
     .from = "standard",
     .says = "GN oversaturates neurons",
     .conditions = {above("saturated share of 24 seeds",
                          from_at_least(kSeeds, saturated_share({"gn"})),
                          saturated_share(Select{"gn"}.in(kWell))),
                    at_least("seeds of 24 with a saturated neuron",
                             from_at_least(kSeeds, seeds_with_saturation("gn")),
                             0.5)},
     .note = "Against gamma = 1; tau = 1e-4.",
     .cause = fails("with 24 seeds a neuron saturates on a third of them, not "
                    "on half; the share is 0.048, and 0.018 with gamma = 1")},
    {.id = "P10",
     .where = "Sec. 2.2, Fig. 1b",
     .from = "standard",
     .says = "HIG avoid oversaturating neurons, in contrast to GN",
     .conditions = {above("saturated share of GN less HIG's, 24 seeds, in "
                          "standard errors",
                          from_at_least(kSeeds, errors_apart("gn", "hig")),
                          2)},
     .cause =
         fails("with 24 seeds HIG saturates 3 of 168 neurons and GN 8: no more "
               "than the seeds scatter")},
};

const std::vector<Claim> kBetween = {
    {.id = "A7",
     .says = "HIG has the lowest median",
     .conditions = {reported("HIG", after("hig")),
                    above("Adam", after("adam"), after("hig")),
                    above("GN", after("gn"), after("hig")),
                    above("GN with HIG's cut", after("gn_tau6"), after("hig")),
                    above("SGD", after("sgd"), after("hig"))}}};

}  // namespace

void add_claims(Registry& r) {
  r.add_claims(kGammas[0].experiment, kWellConditioned);
  r.add_claims(kGammas[1].experiment, kBetween);
  r.add_claims(kGammas[2].experiment, kIllConditioned);
}

}  // namespace physinv::toy
