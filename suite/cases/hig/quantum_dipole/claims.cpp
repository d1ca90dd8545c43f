// What HIG paper Sec. 3.3, App. B.4 and C, Figs. 4, 8 to 11 say of the quantum
// dipole steered by a network, and what our runs showed.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "suite/cases/hig/quantum_dipole/direct_metrics.h"
#include "suite/cases/hig/quantum_dipole/grids.h"
#include "suite/cases/hig/quantum_dipole/metrics.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training.h"
#include "suite/harness/registry.h"

namespace physinv::dipole {
namespace {

// ---- runs -------------------------------------------------------------------

const Select kHig{"hig"}, kHigSlow{"hig-b16-eta025-tau5"},
    kHigFast{"hig-b16-eta10-tau5"}, kGn{"gn"}, kAdam{"adam"},
    kAdam3{"adam-b16-3e-4"}, kAdam10{"adam-b16-1e-3"}, kAdam30{"adam-b16-3e-3"},
    kAdam256{"adam-b256-5e-4"}, kTau2{"hig-b16-eta05-tau2"},
    kTau3{"hig-b16-eta05-tau3"}, kTau4{"hig-b16-eta05-tau4"},
    kTau6{"hig-b16-eta05-tau6"};
/// Fig. 4b's, as far as the text tells; its rates are not printed.
const std::vector<Select> kFig4Hig = {kHig, kHigSlow, kHigFast},
                          kFig4Adam = {kAdam, kAdam3, kAdam10, kAdam30};

/// 90 minutes (from the authors' scripts) by the paper's clock.
constexpr double kEnd = 5400;

/// Table 5 begins at b = 256 for Adam; smaller batches are taken to last as
/// long, and convolutions as long as dense layers.
Clock paper() {
  const auto seconds = [](const Run& run) {
    double batch = 16;
    for (const auto& [name, value] : run.stage->options)
      if (name == "batch") batch = std::stod(value);
    const bool hig = run.stage->arrays.contains("kept");
    const auto row = hig ? "hig/b=" + std::string(batch < 16 ? "8" : "16")
                         : "adam/b=" + std::string(batch > 512   ? "1024"
                                                   : batch > 256 ? "512"
                                                                 : "256");
    return run.evidence->published.find(kDense, "table5/" + row + "/update");
  };
  return {[=](const Run& run, double time) -> std::optional<LossPoint> {
            const auto each = seconds(run);
            if (!each) return {};
            return level_at(run.stage, time / each->value);
          },
          [=](const Run& run, const LossPoint& p) -> std::optional<double> {
            const auto each = seconds(run);
            if (!each) return {};
            return p.updates * each->value;
          }};
}

// ---- numbers ----------------------------------------------------------------

constexpr RowOfCurve kLowLoss{"metrics", kLow}, kHighLoss{"metrics", kHigh};

/// Longest stretch of a test loss between the two.
RunValue stalled(const Clock& clock, double from, double to) {
  return [=](const Run& run) -> std::optional<double> {
    const CurveRow loss{*run.stage};
    double longest = 0, since = -1;
    for (Index k = 0; k < loss.points(); ++k) {
      const auto now = clock.time(run, loss_point(*run.stage, k));
      if (!now) return {};
      const bool inside = loss(k) >= from && loss(k) <= to;
      if (!inside) since = -1;
      if (inside && since < 0) since = *now;
      if (inside) longest = std::max(longest, *now - since);
    }
    return longest;
  };
}

/// Updates until HE < 0.1 over updates until LE < 0.1; empty without the first.
std::optional<double> lag(const Run& run) {
  const auto high = first_below(0.1, kHighLoss)(run),
             low = first_below(0.1, kLowLoss)(run);
  if (!high || !low || !std::isfinite(*high)) return {};
  return *high / *low;
}

/// Until HE < 0.1: the largest of f(LE, its lowest value so far).
template <class F>
std::optional<double> until_high(const Run& run, double level, F f) {
  const CurveRow low{*run.stage, "metrics", kLow},
      high{*run.stage, "metrics", kHigh};
  double lowest = std::numeric_limits<double>::infinity(), most = 0;
  for (Index k = 0; k < low.points(); ++k) {
    lowest = std::min(lowest, low(k));
    if (lowest < level) most = std::max(most, f(low(k), lowest));
    if (high(k) < 0.1) return most;
  }
  return {};
}
/// Largest rise of LE over its lowest value so far.
std::optional<double> rise(const Run& run) {
  return until_high(run, 1e300, [](double a, double b) { return a - b; });
}
/// The same as a ratio, once LE has been below 0.1.
std::optional<double> rise_ratio(const Run& run) {
  return until_high(run, 0.1, [](double a, double b) { return a / b; });
}

/// Median test loss of the last three points of the curve.
std::optional<double> settled(const Run& run) {
  const CurveRow loss{*run.stage};
  const Index last = loss.points() - 1;
  if (last < 2) return {};
  return median({loss(last), loss(last - 1), loss(last - 2)});
}

enum class Side { above, below };
/// What four seeds of five (two of three) stay above or below.
Quantity of_most(Side side, const Select& select, const RunValue& value) {
  return {
      [=](const Evidence& e) {
        auto values = values_of(sample(e, select, value));
        if (values.empty()) return missing(select.text() + " too short");
        std::sort(values.begin(), values.end());
        const auto count = values.size(),
                   enough = std::max<std::size_t>(1, 4 * count / 5);
        return Measured{
            .value = values[side == Side::below ? enough - 1 : count - enough],
            .runs = static_cast<Index>(count)};
      },
      {select}};
}

std::vector<Quantity> medians(const std::vector<Select>& of,
                              const RunValue& value) {
  std::vector<Quantity> all;
  for (const Select& select : of) all.push_back(median(select, value));
  return all;
}
std::vector<Quantity> lowests(const std::vector<Select>& of,
                              const RunValue& value) {
  std::vector<Quantity> all;
  for (const Select& select : of) all.push_back(lowest(select, value));
  return all;
}

Quantity after(const Select& select, double count) {
  return median(select, loss_after(count));
}

/// Updates to a test loss of 0.1 of runs as long as the slowest may take.
RunValue to_a_tenth(double count) { return if_ran(count, first_below(0.1)); }
Quantity over_hig(const Select& adam, double count) {
  return also_asks(
      of_most(Side::above,
              adam,
              over(to_a_tenth(count), beside(kHig, to_a_tenth(224)))),
      {kHig});
}

// ---- claims -----------------------------------------------------------------

constexpr const char* kFrom24 =
    "Bounds: ends of tolerance intervals from 24 seeds, which hold 80 % of all "
    "seeds with a confidence of 95 %.";

const std::vector<Claim> kDenseSuite = {
    {.id = "A1",
     .from = "quick",
     .says = "HIG leaves the plateau within 160 updates on most seeds",
     .conditions = {at_most("after 160 updates, four seeds of five",
                            of_most(Side::below, kHig, loss_after(160)),
                            0.15)}},
    {.id = "A1b",
     .from = "standard",
     .says = "HIG after 512 updates",
     .conditions = {at_most("median", after(kHig, 512), 2e-2),
                    at_most("lowest", lowest(kHig, loss_after(512)), 5e-4),
                    at_most("highest", highest(kHig, loss_after(512)), 0.1)}},
    {.id = "A2",
     .from = "quick",
     .says =
         "To a test loss of 0.1, HIG takes fewer updates than Adam with b = "
         "256; four seeds of five keep each bound",
     .conditions = {at_most("HIG",
                            of_most(Side::below, kHig, to_a_tenth(224)),
                            189),
                    at_least("Adam b=256",
                             of_most(Side::above, kAdam256, to_a_tenth(960)),
                             300),
                    at_most("Adam b=256",
                            of_most(Side::below, kAdam256, to_a_tenth(960)),
                            1000),
                    at_least("over HIG", over_hig(kAdam256, 960), 2.5)},
     .note = "HIG's bound: end of a tolerance interval from 24 seeds (80 % of "
             "all, confidence 95 %); the others stand as earlier runs set "
             "them."},
    {.id = "A2b",
     .from = "standard",
     .says = "The same for Adam with b = 16 and 1e-4",
     .conditions = {at_least("Adam b=16",
                             of_most(Side::above, kAdam, to_a_tenth(8000)),
                             2354),
                    at_most("Adam b=16",
                            of_most(Side::below, kAdam, to_a_tenth(8000)),
                            5990),
                    at_least("over HIG", over_hig(kAdam, 8000), 14.1)},
     .note = kFrom24},
    {.id = "A3",
     .from = "quick",
     .says = "Adam (b=16, 1e-4) stays near one half for long, HIG does not",
     .conditions = {at_least(
                        "Adam b=16 in [0.4, 0.56], four seeds of five",
                        of_most(Side::above,
                                kAdam,
                                if_ran(3000, stalled(updates(), 0.4, 0.56))),
                        1000),
                    at_most("HIG, longest",
                            highest(kHig, stalled(updates(), 0.4, 0.56)),
                            64)}},
    {.id = "A4",
     .from = "quick",
     .says =
         "HIG lowers the losses of both levels together; four seeds of five "
         "keep each bound",
     .conditions = {at_most("lag", of_most(Side::below, kHig, lag), 1.9),
                    at_most("rise", of_most(Side::below, kHig, rise), 0.0192)},
     .note = kFrom24},
    {.id = "A4b",
     .from = "standard",
     .says = "Adam (b=16, 1e-4) lowers the low level first and lets it rise "
             "again",
     .conditions =
         {at_least("lag", of_most(Side::above, kAdam, if_ran(8000, lag)), 2.89),
          at_least(
              "rise", of_most(Side::above, kAdam, if_ran(8000, rise)), 0.0325)},
     .note = kFrom24},
    {.id = "A5",
     .from = "standard",
     .says = "Of Adam's rates (b=16), a large one falls first and ends higher "
             "than a small one",
     .conditions = {at_most("1e-3 to 1e-2, median updates",
                            median(kAdam10, if_ran(2000, first_below(1e-2))),
                            2000),
                    above("1e-4 to 1e-2, median updates",
                          median(kAdam, if_ran(8000, first_below(1e-2))),
                          4000),
                    above("after 25000, loss at 3e-3 over 1e-4",
                          ratio(median(kAdam30, if_ran(25'000, settled)),
                                median(kAdam, if_ran(25'000, settled))),
                          1)}},
    {.id = "A6",
     .from = "standard",
     .says = "After 256 updates HIG does well for tau 1e-3 and worse for 1e-2; "
             "with the gradient projected, 1e-6 is as good as 1e-5",
     .conditions = {at_most("tau 1e-3", after(kTau3, 256), 5e-3),
                    report("1e-4", after(kTau4, 256)),
                    above("tau 1e-2 over 1e-3",
                          ratio(after(kTau2, 256), after(kTau3, 256)),
                          10),
                    within("tau 1e-6 over 1e-5",
                           ratio(after(kTau6, 256), after(kHig, 256)),
                           0.2,
                           5)}},
    {.id = "A8",
     .from = "quick",
     .says = "Gauss-Newton (not in the paper) stays finite on all seeds",
     .conditions = {at_most("highest end", highest(kGn, last_loss()), 1),
                    report("median", median(kGn, last_loss())),
                    report("HIG", median(kHig, last_loss()))}}};

const std::vector<Claim> kDensePaper =
    {{.id = "P1",
      .origin = Origin::paper,
      .where = "Sec. 3.3, Fig. 4b",
      .from = "standard",
      .says = "HIG minimises the loss faster than Adam",
      .conditions =
          {below("time to 1e-2 by the paper's clock, HIG over the fastest Adam "
                 "but for the largest rate",
                 ratio(median(kHig, time_to(paper(), 1e-2)),
                       least(medians({kAdam, kAdam10, kAdam256},
                                     time_to(paper(), 1e-2)))),
                 1),
           below("the same on the best seeds",
                 ratio(lowest(kHig, time_to(paper(), 1e-2)),
                       least(lowests({kAdam, kAdam10, kAdam256},
                                     time_to(paper(), 1e-2)))),
                 1),
           report("over Adam with the largest rate",
                  ratio(median(kHig, time_to(paper(), 1e-2)),
                        median(kAdam30, time_to(paper(), 1e-2))))},
      .note = "That Adam with the largest rate drops first, the paper says "
              "itself (P3). Table 5 has no Adam with b = 16; it is taken to "
              "last as long as with 256, which favours HIG."},
     {.id = "P2",
      .origin = Origin::paper,
      .where = "Sec. 3.3, Fig. 4b",
      .from = "paper",
      .says = "HIG reaches a better final accuracy than Adam",
      .conditions =
          {below("end of the best HIG over the best Adam",
                 ratio(least(medians(kFig4Hig, loss_at(paper(), kEnd))),
                       least(medians(kFig4Adam, loss_at(paper(), kEnd)))),
                 1),
           below("on the best seeds",
                 ratio(least(lowests(kFig4Hig, loss_at(paper(), kEnd))),
                       least(lowests(kFig4Adam, loss_at(paper(), kEnd)))),
                 1),
           report("Adam b=256", median(kAdam256, loss_at(paper(), kEnd)))},
      .note = "After 5400 s by the paper's clock; the rates of Fig. 4b are not "
              "printed."},
     {.id = "P3",
      .origin = Origin::paper,
      .where = "Sec. 3.3, Fig. 4b",
      .from = "paper",
      .says = "Adam with the largest rate drops first and ends worst of all",
      .conditions = {below("time to 0.5, rate 3e-3 over the fastest other Adam",
                           ratio(median(kAdam30, time_to(paper(), 0.5)),
                                 least(medians({kAdam, kAdam3, kAdam10},
                                               time_to(paper(), 0.5)))),
                           1),
                     above("its end over the highest other",
                           ratio(median(kAdam30, loss_at(paper(), kEnd)),
                                 most({most(medians({kAdam, kAdam3, kAdam10},
                                                    loss_at(paper(), kEnd))),
                                       most(medians(kFig4Hig,
                                                    loss_at(paper(), kEnd)))})),
                           1)}},
     {.id = "P4",
      .origin = Origin::paper,
      .where = "Sec. 3.3",
      .from = "paper",
      .says = "The final losses differ less than in the other experiments",
      .conditions = {below(
          "Adam over HIG at the end",
          ratio(least(medians(kFig4Adam, loss_at(paper(), kEnd))),
                least(medians(kFig4Hig, loss_at(paper(), kEnd)))),
          ratio(median(Select{"adam"}.in("hig/oscillators"), last_loss()),
                median(Select{"hig"}.in("hig/oscillators"), last_loss())))},
      .note = "The other one: the oscillators, whose runs end after an hour of "
              "the paper's clock.",
      .cause = not_run("4 CPU-minutes a seed: Adam and HIG on the oscillators "
                       "beside these runs, at the profile paper")},
     {.id = "P5",
      .origin = Origin::paper,
      .where = "Sec. 3.3",
      .from = "paper",
      .says = "A pure physics optimisation reaches about 1e-6, and networks "
              "cannot improve beyond",
      .conditions = {near("control alone in float, 1 - |<t, psi>|^2",
                          median(Select{"hig-f32"}.in(kDirect),
                                 last_of({"metrics", kOverlap})),
                          1e-6),
                     at_least("lowest test loss of a network",
                              least({least(lowests(kFig4Hig, lowest_loss())),
                                     least(lowests(kFig4Adam, lowest_loss()))}),
                              3e-7),
                     report("control alone in float, |psi - <t, psi> t|^2",
                            median(Select{"hig-f32"}.in(kDirect),
                                   last_of({"metrics", kRest}))),
                     report("control alone in double",
                            median(Select{"hig"}.in(kDirect), last_loss()))},
      .note = "In float the printed loss cancels; by a formula that does not, "
              "and in double, there is no such floor (A9). Our networks train "
              "in double.",
      .cause = fails(
          "the floor is single precision's: by the printed formula, which "
          "cancels, control alone ends at 3.3e-6 in float; in double it comes "
          "to 1e-15 and networks to 5e-8")},
     {.id = "P6",
      .origin = Origin::paper,
      .where = "Sec. 3.3, Fig. 4b",
      .from = "standard",
      .says = "Adam stagnates at 0.5, most of all with 1e-4; HIG decreases "
              "faster below",
      .conditions = {above("updates in 0.4 .. 0.6, rate 1e-4",
                           median(kAdam, stalled(updates(), 0.4, 0.6)),
                           most(medians({kAdam10, kAdam30},
                                        stalled(updates(), 0.4, 0.6)))),
                     below("HIG",
                           median(kHig, stalled(updates(), 0.4, 0.6)),
                           least(medians({kAdam, kAdam10, kAdam30},
                                         stalled(updates(), 0.4, 0.6)))),
                     below("HIG, seconds by the paper's clock",
                           median(kHig, stalled(paper(), 0.4, 0.6)),
                           least(medians({kAdam, kAdam10, kAdam30},
                                         stalled(paper(), 0.4, 0.6))))}},
     {.id = "P7",
      .origin = Origin::paper,
      .where = "Sec. 3.3, Fig. 4c",
      .from = "standard",
      .says = "Adam minimises the low-energy loss first and increases it again "
              "before it minimises the high-energy loss",
      .conditions = {above("updates to 0.1, HE over LE",
                           median(kAdam, if_ran(8000, lag)),
                           1),
                     above("then LE over its lowest, before HE < 0.1",
                           median(kAdam, if_ran(8000, rise_ratio)),
                           1.2)}},
     {.id = "P8",
      .origin = Origin::paper,
      .where = "Sec. 3.3, Fig. 4c",
      .from = "standard",
      .says = "HIG minimises both losses uniformly",
      .conditions = {below("updates to 0.1, HE over LE",
                           median(kHig, lag),
                           median(kAdam, if_ran(8000, lag)))}},
     {.id = "P9",
      .origin = Origin::paper,
      .where = "App. B.4, Fig. 9",
      .from = "standard",
      .says = "HIG is accurate for tau from 1e-5 to 1e-3 and worse for 1e-2",
      .conditions =
          {either(at_most("after 256 updates, highest over lowest of the three",
                          ratio(most({after(kHig, 256),
                                      after(kTau4, 256),
                                      after(kTau3, 256)}),
                                least({after(kHig, 256),
                                       after(kTau4, 256),
                                       after(kTau3, 256)})),
                          10),
                  below("highest",
                        most({after(kHig, 256),
                              after(kTau4, 256),
                              after(kTau3, 256)}),
                        1e-2)),
           above("tau 1e-2 over the highest of them",
                 ratio(after(kTau2, 256),
                       most({after(kHig, 256),
                             after(kTau4, 256),
                             after(kTau3, 256)})),
                 1),
           report("b=8, tau 1e-2 over 1e-3",
                  ratio(after({"hig-b8-eta05-tau2"}, 256),
                        after({"hig-b8-eta05-tau3"}, 256)))}},
     {.id = "P10",
      .origin = Origin::paper,
      .where = "App. C, Fig. 9",
      .from = "standard",
      .says = "With tau far below 1e-5 the network does not learn, and a pure "
              "physics optimisation does worse",
      .conditions =
          {above("float, gradient as it is, tau 1e-7: lowest test loss",
                 lowest({"hig-f32-raw-tau7"}, lowest_loss()),
                 0.1),
           above("control alone in float, tau 1e-7 over 1e-5",
                 ratio(median(Select{"hig-f32-tau7"}.in(kDirect), last_loss()),
                       median(Select{"hig-f32"}.in(kDirect), last_loss())),
                 1),
           report("double, tau 1e-6, test loss after 256", after(kTau6, 256)),
           report("control alone in double, tau 1e-7 over 1e-5",
                  ratio(median(Select{"hig-tau7"}.in(kDirect), last_loss()),
                        median(Select{"hig"}.in(kDirect), last_loss())))},
      .note = "Controls alone are updated by projected gradients.",
      .cause = depends(
          "a tau far below 1e-5 is not printed, nor whether the control's "
          "gradient is projected: with 1e-7 the lowest test loss is 0.014, "
          "with 1e-8 it was 0.50 (one seed); control alone, not projected, "
          "stays at 0.92 to 0.99 for 128 updates")},
     {.id = "P11",
      .origin = Origin::paper,
      .where = "App. B.4, Fig. 9",
      .from = "quick",
      .says =
          "HIG's plateau at the start comes from the start-up of TensorFlow, "
          "not from HIG",
      .conditions = {below("after 20 updates, over the start",
                           median(kHig, over(loss_after(20), first_loss())),
                           0.9)},
      .cause = fails(
          "HIG's first plateau stands without TensorFlow: after 20 updates the "
          "loss is 0.99 to 1.00 of the start, it falls after 46 to 128")}};

const Select kCnnTau3{"hig-b16-eta07-tau3"}, kCnnTau5{"hig-b16-eta07-tau5"};

const std::vector<Claim> kConvolutions = {
    {.id = "A7",
     .from = "standard",
     .says = "With the convolutional network, HIG after 256 updates is below "
             "Adam (b=256, 2e-4) after 600",
     .conditions = {at_most("HIG after 256, median", after(kHig, 256), 5e-3),
                    above("Adam b=256 after 600, median",
                          after(kAdam, 600),
                          1e-2)}},
    {.id = "P12",
     .origin = Origin::paper,
     .where = "App. B.4, Figs. 10, 11",
     .from = "paper",
     .says = "With convolutions, tau from 1e-5 to 1e-3 is stable, and the best "
             "HIG run is faster and more accurate than the best Adam run",
     .conditions = {at_most("of the seeds with tau 1e-3, 1e-4, 1e-5, diverged",
                            most({highest(kCnnTau3, diverged()),
                                  highest(kHig, diverged()),
                                  highest(kCnnTau5, diverged())}),
                            0),
                    below("time to 1e-2 by the paper's clock, HIG over Adam",
                          ratio(median(kHig, time_to(paper(), 1e-2)),
                                median(kAdam, time_to(paper(), 1e-2))),
                          1),
                    below("end, HIG over Adam",
                          ratio(median(kHig, loss_at(paper(), kEnd)),
                                median(kAdam, loss_at(paper(), kEnd))),
                          1)},
     .note = "Table 5 is of the dense network; its seconds are taken for both.",
     .cause = not_run("16 CPU-minutes for one seed of the four runs, the "
                      "profile paper")}};

const bool kClaims = register_claims(kDense, kDenseSuite) &&
                     register_claims(kDense, kDensePaper) &&
                     register_claims(kConvolutional, kConvolutions);

}  // namespace
}  // namespace physinv::dipole
