// HIG paper, Sec. 3.1, App. B.2 and C. U: at equal updates. C: at equal time
// by the paper's clock, updates times the seconds of Table 3.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "suite/cases/hig/oscillators/quantities.h"
#include "suite/harness/registry.h"

namespace physinv::oscillators {
namespace {

// ---- the suite's own ranges -------------------------------------------------

constexpr const char* kOf24 =
    "Ranges: lowest to highest of 24 seeds, which hold 80 % of all seeds with "
    "95 % confidence.";

const std::vector<Claim> kRanges =
    {{.id = "A1",
      .says =
          "HIG brings the test loss down in 320 updates, hardly ever rising",
      .conditions =
          {within("median after 320", median_after({"hig"}, 320), 1e-4, 2e-3),
           at_most("rise over the lowest so far",
                   highest({"hig"}, largest_rise()),
                   2)}},
     {.id = "A1b",
      .from = "standard",
      .says = "HIG goes on to fall up to 2000 updates",
      .conditions = {within(
          "median after 2000", median_after({"hig"}, 2000), 5e-6, 2e-4)}},
     {.id = "A2",
      .says = "By the paper's clock HIG is below Adam; at equal updates Adam "
              "leads the first-order rules",
      .conditions = {below("HIG over Adam, 320 updates",
                           by_clock("hig", "adam", 320 * kHigUpdate),
                           0.2),
                     above("SGD, 300 updates",
                           median_after({"sgd"}, 300),
                           median_after({"adam"}, 300)),
                     above("Adadelta, 300 updates",
                           median_after({"adadelta"}, 300),
                           median_after({"adam"}, 300)),
                     above("RMSprop, 300 updates",
                           median_after({"rmsprop"}, 300),
                           median_after({"adam"}, 300))}},
     {.id = "A2b",
      .from = "standard",
      .says = "By the paper's clock HIG is below Adam later, too",
      .conditions = {below("HIG over Adam, 2000 updates",
                           by_clock("hig", "adam", 2000 * kHigUpdate),
                           0.2)}},
     {.id = "A3",
      .from = "standard",
      .says = "Most seeds of Gauss-Newton diverge or triple their loss",
      .conditions = {at_least("unstable seeds of 8",
                              from_at_least(8, count({"gn"}, unstable, is_one)),
                              3),
                     reported("best stable over HIG, 320 updates",
                              ratio(lowest({"gn"}, if_stable(loss_after(320))),
                                    median_after({"hig"}, 320))),
                     reported("2000 updates",
                              ratio(lowest({"gn"}, if_stable(loss_after(2000))),
                                    median_after({"hig"}, 2000)))},
      .note = "Of 24 seeds 19 are unstable: at least 61 % of all with 95 % "
              "confidence, and then 3 or more of 8 in 95 of 100 "
              "campaigns. Two of 24 come within ten times HIG's loss: too few "
              "for a range."},
     {.id = "A4",
      .says = "After 256 updates kappa = -1/2 is far below 1/2, and mostly "
              "below 0",
      .conditions =
          {within(
               "kappa=-1/2", median_after({"kappa-m05"}, 256), 3.6e-4, 2.8e-3),
           within("kappa=0", median_after({"kappa-0"}, 256), 9.6e-4, 6.7e-2),
           within("kappa=1/2", median_after({"kappa-05"}, 256), 0.11, 0.77)},
      .note = kOf24},
     {.id = "A4b",
      .from = "standard",
      .says = "The other exponents after 256 updates; kappa = 1 diverges",
      .conditions =
          {within(
               "kappa=-3/4", median_after({"kappa-m075"}, 256), 2.4e-4, 2.9e-3),
           within(
               "kappa=-1/4", median_after({"kappa-m025"}, 256), 3.4e-4, 2.1e-3),
           within(
               "kappa=1/4", median_after({"kappa-025"}, 256), 4.2e-3, 7.8e-2),
           at_least("kappa=1, share of seeds diverged",
                    share({"kappa-1"}, diverged(), is_one),
                    1)},
      .note = kOf24},
     {.id = "A4c",
      .from = "standard",
      .says = "After 1024 updates -1/2 ends lowest, 0 and 1/2 far higher",
      .conditions =
          {at_most("kappa=-1/2 over the lowest other",
                   ratio(median_after({"kappa-m05"}, 1024),
                         least(medians(
                             runs_of(kOtherExponents), loss_after(1024)))),
                   2),
           above("kappa=1/2", median_after({"kappa-05"}, 1024), 0.1),
           above("kappa=0 over -1/2",
                 ratio_of_medians({"kappa-0"}, {"kappa-m05"}, loss_after(1024)),
                 10)},
      .note = "Bounds from three seeds, not from many."},
     {.id = "A5",
      .from = "standard",
      .says =
          "At equal updates (256, b = 64) a smaller beta ends higher: it is "
          "a shorter step",
      .conditions = {within("beta=-1/4 over 0",
                            ratio_of_medians(
                                {"beta-m250"}, {"kappa-m05"}, loss_after(256)),
                            5,
                            40),
                     within("beta=-1/2 over 0",
                            ratio_of_medians(
                                {"beta-m500"}, {"kappa-m05"}, loss_after(256)),
                            30,
                            250)},
      .note = "The paper saw little influence on the outcome: P10."},
     {.id = "A6",
      .from = "standard",
      .says = "HIG depends little on tau",
      .conditions = {at_most("highest over lowest, 256 updates, 1e-5 .. 1e-8",
                             spread_of_seeds(runs_of({kHigCuts.begin(),
                                                      kHigCuts.begin() + 4}),
                                             loss_after(256)),
                             2.4),
                     at_most("at the end, 1e-5 .. 1e-10",
                             spread_of_seeds(runs_of(kHigCuts), last_loss()),
                             10)},
      .note = "Median of each seed's ratio. The first bound is the highest of "
              "24 seeds, above 80 % of all with 95 % confidence (19 of 24 are "
              "below 1.1); the second is from three seeds."},
     {.id = "A7",
      .from = "standard",
      .says = "HIG with b = 64 is mostly ahead of b = 32",
      .conditions =
          {within("b=32 over 64, 128 updates",
                  median_ratio({"hig-b32"}, {"kappa-m05"}, loss_after(128)),
                  0.66,
                  4.5),
           within("b=32 over 64, 256 updates",
                  median_ratio({"hig-b32"}, {"kappa-m05"}, loss_after(256)),
                  0.45,
                  4.1),
           within("b=32 over 64, 1024 updates",
                  median_ratio({"hig-b32"}, {"kappa-m05"}, loss_after(1024)),
                  0.34,
                  6.9)},
      .note = std::string("Medians of ratios of one seed. ") + kOf24},
     {.id = "A7b",
      .from = "standard",
      .says = "b = 128 is level with 64 and later ahead of 32; Adam's batch "
              "size matters little",
      .conditions =
          {within("b=128 over 64, 256 updates",
                  ratio_of_medians({"hig"}, {"kappa-m05"}, loss_after(256)),
                  0.5,
                  2),
           above("b=32 over 128, 1024 updates",
                 ratio_of_medians({"hig-b32"}, {"hig"}, loss_after(1024)),
                 1),
           at_most("Adam, highest over lowest b",
                   spread_of(kAdamBatches, loss_after(4000)),
                   3)},
      .note = "Bounds from three seeds, not from many."}};

// ---- the paper --------------------------------------------------------------

/// P2: a rule's fall in the last half, and that it stays above HIG.
std::vector<Condition> stagnation() {
  std::vector<Condition> all;
  for (const auto& id : kFirstOrder) {
    all.push_back(below(id + ", fall in the last half",
                        median({id}, over(loss_at_share(0.5), last_loss())),
                        3));
    all.push_back(
        above(id + ", end over HIG's", by_clock(id, "hig", kHour), 1));
  }
  return all;
}

/// P9: at the smallest rate the batch size matters little, at the largest the
/// loss jumps more.
std::vector<Condition> rates_and_batches() {
  std::vector<Condition> all;
  for (const Grid& grid : kGrids) {
    const auto ids = [&](double rate) {
      Ids some;
      for (const Index b : kGridBatches)
        some.push_back(grid_id(grid.rule, rate, b));
      return some;
    };
    const auto jumps = [&](double rate) {
      return most(medians(runs_of(ids(rate)), scatter()));
    };
    std::vector<Quantity> spreads;
    for (const double rate : grid.rates)
      spreads.push_back(spread_or_unstable(ids(rate), last_loss()));
    all.push_back(at_most(fmt::format("{}, highest over lowest b, at its "
                                      "most even rate",
                                      grid.rule),
                          least(spreads),
                          3.2));
    all.push_back(
        above(fmt::format("{}, scatter at the largest over the smallest rate, "
                          "infinite if it diverges",
                          grid.rule),
              ratio(jumps(grid.rates.back()), jumps(grid.rates.front())),
              1));
  }
  return all;
}

/// P12, for each tau.
std::vector<Condition> cuts() {
  std::vector<Condition> all = {at_most(
      "HIG, highest over lowest end", spread_of(kHigCuts, last_loss()), 10)};
  for (std::size_t i = 0; i < kHigCuts.size(); ++i)
    all.push_back(below(fmt::format("HIG's end with tau 1e-{}", i + 5),
                        median_at_end({kHigCuts[i]}),
                        median_at_end({kGnCuts[i]})));
  all.push_back(at_most("HIG runs diverged, most of a tau",
                        most(each(kHigCuts,
                                  [](const auto& id) {
                                    return count({id}, diverged(), is_one);
                                  })),
                        0));
  for (const char* id : {"gn-tau9", "gn-tau10"})
    all.push_back(above(fmt::format("{}, share of seeds diverged", id),
                        share({id}, diverged(), is_one),
                        0.5));
  all.push_back(above("GN, share diverged with tau 1e-10 over 1e-5",
                      share({"gn-tau10"}, diverged(), is_one),
                      share({"gn-tau5"}, diverged(), is_one)));
  return all;
}

constexpr const char* kOfFig12 =
    "At b = 64; the batch size of this figure is not printed (Table 2: 128).";

const std::vector<Claim> kPaper = {
    {.id = "P1",
     .where = "Sec. 3.1, Fig. 2b",
     .from = "standard",
     .says = "Adam is the best of the first-order rules, with a final loss of "
             "1e-4",
     .conditions =
         {near("Adam's end, best seed", lowest_at_end({"adam"}), 1e-4),
          above("lowest of the others over Adam, medians at the end",
                ratio(least(medians(
                          runs_of({"sgd", "adagrad", "adadelta", "rmsprop"}),
                          last_loss())),
                      median_at_end({"adam"})),
                1),
          reported("Adam's end, median", median_at_end({"adam"}))},
     .note = "One clock for all first-order rules; standard runs 54 of the "
             "paper's 60 minutes."},
    {.id = "P2",
     .where = "Sec. 3.1, Fig. 2b",
     .says = "The first-order rules stagnate early",
     .conditions = stagnation()},
    {.id = "P3",
     .where = "Sec. 3.1, Fig. 2b",
     .from = "standard",
     .says = "HIG and GN exceed Adam's accuracy after about three minutes",
     .conditions =
         {below("HIG over Adam after 290 s",
                by_clock("hig", "adam", kFiveMinutes),
                1),
          below("best stable GN over Adam after 290 s",
                ratio(lowest({"gn"}, at_paper_time(kFiveMinutes)),
                      median({"adam"}, at_paper_time(kFiveMinutes))),
                1),
          reported(
              "seconds of HIG to Adam's loss then",
              depends_on(median({"hig"},
                                time_to(kPaperClock,
                                        beside({"adam"},
                                               at_paper_time(kFiveMinutes)))),
                         {{"adam"}})),
          within("seconds of HIG to Adam's end",
                 depends_on(median({"hig"},
                                   time_to(kPaperClock,
                                           beside({"adam"}, last_loss()))),
                            {{"adam"}}),
                 kThreeMinutes / 2,
                 2 * kThreeMinutes)},
     .note = "C: below Adam's curve after 290 s, and at Adam's end after "
             "half to twice three minutes."},
    {.id = "P4",
     .where = "Sec. 3.1, Fig. 2b",
     .says = "HIG yield the best result, a loss of 1e-7",
     .conditions =
         {near("HIG's end, best seed", lowest_at_end({"hig"}), 1e-7),
          below("HIG over Adam, end", by_clock("hig", "adam", kHour), 1),
          below("HIG's end", median_at_end({"hig"}), median_at_end({"gn"})),
          reported("best seeds, HIG over GN",
                   ratio(lowest_at_end({"hig"}), lowest_at_end({"gn"})))}},
    {.id = "P5",
     .where = "Sec. 3.1, Fig. 2b",
     .says = "The best stable run of GN reaches 1e-6",
     .conditions = {near("GN's end, best of 8 seeds",
                         from_at_least(8, lowest_at_end({"gn"})),
                         1e-6)}},
    {.id = "P6",
     .where = "Sec. 3.1",
     .from = "standard",
     .says = "GN exhibits stability problems, HIG is robust",
     .conditions = {above("share of GN's seeds that diverge",
                          from_at_least(8, share({"gn"}, diverged(), is_one)),
                          share({"hig"}, diverged(), is_one))}},
    {.id = "P7",
     .where = "Sec. 3.1, Fig. 2c",
     .from = "standard",
     .says = "Adam converges about equally quickly with all batch sizes",
     .conditions = {at_most(
         "highest over lowest b, from 500 updates on",
         highest_along({kAdamBatches.front()},
                       500,
                       [](double updates) {
                         return spread_of(kAdamBatches, loss_after(updates));
                       }),
         3.2)}},
    {.id = "P8",
     .where = "Sec. 3.1, Fig. 2c",
     .says = "HIG and GN improve with larger batches",
     .conditions = {below("HIG, b = 128 over 32",
                          by_clock("hig", "hig-b32", 2140),
                          1),
                    below("GN, b = 128 over 32, best seeds",
                          ratio(lowest({"gn"}, at_paper_time(2140)),
                                lowest({"gn-b32"}, at_paper_time(2140))),
                          1)},
     .note = "C, where the run with b = 32 ends. Most seeds of GN diverge.",
     .cause = fails(
         "where the runs with b = 32 end, HIG with b = 128 (one seed) is at "
         "1.7 times their median (five seeds), and GN's only stable seed of "
         "eight at 1.2 times the best with b = 32")},
    {.id = "P9",
     .where = "App. B.2, Figs. 5, 6",
     .from = "standard",
     .says = "First-order rules change little with the batch size and become "
             "unstable with larger rates",
     .conditions = rates_and_batches(),
     .note = "After 4000 updates or more; the paper's rates are not printed."},
    {.id = "P10",
     .where = "App. C, Fig. 12a",
     .says = "beta has only little influence on the outcome",
     .conditions = {below(
         "highest over lowest beta, end; of kappa from -3/4 to 1/2",
         spread_of(kBetas, last_loss()),
         spread_of(exponents([](double k) { return std::abs(k) < 1; }),
                   last_loss()))},
     .note =
         "With kappa of -1 and 1 most seeds diverge. " + std::string(kOfFig12)},
    {.id = "P11",
     .where = "App. C, Fig. 12b",
     .says = "kappa > 0 stagnates, kappa < 0 ends orders of magnitude lower, "
             "-1/2 lowest",
     .conditions =
         {at_most("highest kappa < 0 over lowest kappa > 0, best seeds",
                  ratio(most(lowests(runs_of(kNegative), last_loss())),
                        least(lowests(runs_of(kPositive), last_loss()))),
                  0.01),
          at_most("kappa = -1/2 over the lowest other, best seeds",
                  ratio(lowest_at_end({"kappa-m05"}),
                        least(lowests(runs_of(kOtherExponents), last_loss()))),
                  1.2)},
     .note = "The text prints beta = -0.5 and means kappa. " +
             std::string(kOfFig12),
     .cause = fails(
         "kappa = -3/4 ends at 4.0e-6 and -1 on the best of its five seeds at "
         "1.6e-6, below -1/2 with 9.6e-6; the worst kappa < 0 ends 44 times "
         "below the best kappa > 0, whose losses do stagnate (one seed)")},
    {.id = "P12",
     .where = "App. C, Fig. 13",
     .says = "HIG tolerate tau 1e-5 to 1e-10 and end lower than GN, which "
             "diverges at 1e-9 and 1e-10",
     .conditions = cuts(),
     .note = "In double; the paper's was single. " + std::string(kOfFig12),
     .cause = not_run(
         "10 CPU-minutes a seed: the cuts of Fig. 13 at the profile paper")},
};

}  // namespace

void add_claims(Registry& r) {
  r.add_claims(kName, kRanges);
  r.add_claims(kName, kPaper);
}

}  // namespace physinv::oscillators
