// What the JPO paper says about the Kuramoto-Sivashinsky equation (Sec. 4,
// Fig. 5, App. D.3), and the ranges that independent programs showed.
#include <cmath>

#include "suite/cases/jpo/common/values.h"
#include "suite/harness/registry.h"

namespace physinv::jpo::kuramoto_sivashinsky {
namespace {

/// From here on the paper's statements hold; small sets can be memorised.
constexpr Index kMany = 32;
constexpr Index kSeeds = 10;  ///< the paper's

const Solved kSolved = within_of_truth(1e-3);

/// Over distinct problems.
Quantity solved_of(Index problems, const Select& runs) {
  return from_problems(
      problems,
      runs,
      share_of_examples(runs, largest_sets(if_solved(kSolved)), holds));
}
Quantity of_solved(const Select& runs, const RunRow& row) {
  return median_of_examples(runs, where(is_solved(kSolved), row));
}

/// The refined run of the same problem is solved.
bool gets_solved(const Run& run, Index i) {
  const auto end = run.beside(kRefined);
  return end && kSolved(end->record->data, *end->stage, i);
}

/// Loss at the end over that of BFGS's start, the mean of the truths.
std::vector<double> loss_over_start(const Run& run) {
  const auto bfgs_run = bfgs_beside(run);
  auto ratios = losses()(run);
  if (!bfgs_run) return {};
  const auto start = start_losses()(*bfgs_run);
  if (start.size() != ratios.size()) return {};
  for (std::size_t i = 0; i < ratios.size(); ++i) ratios[i] /= start[i];
  return ratios;
}

/// Problems that the simulator could not follow.
Quantity diverged(const Select& runs) {
  return share_of_examples(
      runs, losses(), [](double loss) { return !std::isfinite(loss); });
}

/// Sec. 4: BFGS and gradient descent.
const std::vector<Claim> kSolvers = {
    {.id = "P1",
     .where = "Sec. 4",
     .says = "BFGS finds the solution in about 60 % of cases",
     .conditions = {about("solved, %", percent(solved_of(256, bfgs())), 60)}},
    {.id = "P2",
     .where = "Sec. 4",
     .says = "Gradient descent gets stuck in local optima more often than BFGS",
     .conditions = {below(
         "solved by GD", solved_of(256, gd()), solved_of(256, bfgs()))},
     .cause = depends(
         "how many iterations gradient descent has is not printed: with 20 it "
         "solved 0.48 and BFGS 0.52, with 50 and 100 it solved 0.56 and 0.59 "
         "(n = 64); run to its end it solves 0.68, BFGS 0.57")}};

/// Sec. 4: JPO and its refinement.
const std::vector<Claim> kJoint =
    {{.id = "P3",
      .where = "Sec. 4",
      .says = "JPO brings 80 % of the problems to the global minimum",
      .conditions = {about("solved after refinement at n = 256, %",
                           percent(mean(at(kRefined, 256), solved(kSolved))),
                           80),
                     reported("over all n",
                              percent(mean(kRefined, solved(kSolved))))},
      .note = "Of the largest n: the sentence names none.",
      .cause = not_run("n = 256 of the profile paper anew: what is stored "
                       "keeps the mean over all n")},
     {.id = "P4",
      .where = "Sec. 4",
      .says = "Unrefined accuracy stagnates far from machine precision",
      .conditions = {at_least(
          "median L of solved problems, before over after refinement",
          ratio(median_of_examples(kJpo.of_sizes(kMany),
                                   where(gets_solved, losses())),
                of_solved(kRefined.of_sizes(kMany), losses())),
          1e3)}},
     {.id = "P5",
      .where = "Sec. 4",
      .says = "Refinement reaches machine precision in 4 to 17 iterations, "
              "BFGS from the mean needs 12 to 22",
      .conditions =
          {within("median iterations of the refinement",
                  of_solved(kRefined, iterations()),
                  4,
                  17),
           within("of BFGS", of_solved(bfgs(), iterations()), 12, 22),
           below("refinement below BFGS",
                 of_solved(kRefined, iterations()),
                 of_solved(bfgs(), iterations())),
           at_least("share with a refined L below 1e-10 of that at the mean",
                    share_of_examples(
                        kRefined,
                        where(is_solved(kSolved), loss_over_start),
                        [](double ratio) { return ratio <= 1e-10; }),
                    0.9)},
      .note = "Over solved problems.",
      .cause = depends("the tolerance of BFGS is not printed: to a gradient of "
                       "1e-5 it takes a median of 9 to 11 iterations, to 1e-12 "
                       "it took 14, printed are 12 to 22")},
     {.id = "P6",
      .where = "Sec. 4",
      .says = "Performance increases with n; at n = 256 JPO is better than "
              "BFGS in 65 %",
      .conditions = {either(above("f at n = 256 over n = 4",
                                  mean(at(kJpo, 256), f()),
                                  mean(at(kJpo, 4), f())),
                            above("refined",
                                  mean(at(kRefined, 256), f()),
                                  mean(at(kRefined, 4), f()))),
                     either(as_printed("better at n = 256, %",
                                       percent_better(at(kJpo, 256)),
                                       "text/jpo/better/n=256",
                                       kSeeds),
                            as_printed("refined",
                                       percent_better(at(kRefined, 256)),
                                       "text/jpo/better/n=256",
                                       kSeeds))}}};

/// Tables 3 to 5.
const std::vector<Claim> kTables = {
    {.id = "P7",
     .where = "Table 4",
     .says = "How often each method is better than BFGS, and equal",
     .conditions = joined({table4("jpo", kSeeds),
                           table4("supervised", kSeeds),
                           table4("na", kSeeds)}),
     .cause = differs(
         "JPO, supervised learning and the neural adjoint are better in 34, 10 "
         "and 4 %, printed are 42.8, 14.4 and 6.4, in the same order",
         {above("better, %: JPO over supervised",
                percent_better(kJpo),
                percent_better(kSupervised)),
          above("supervised over the neural adjoint",
                percent_better(kSupervised),
                percent_better(kAdjoint))})},
    {.id = "P8",
     .where = "Table 5",
     .says = "The same after refinement",
     .conditions = joined({table5("jpo", kSeeds),
                           table5("supervised", kSeeds),
                           table5("na", kSeeds)}),
     .cause = differs("refined supervised learning is better in 46 %, printed "
                      "are 57.7; the refined neural adjoint ties in 48 %, "
                      "printed 62.2; JPO is as printed, and the order is",
                      {above("better, %: JPO over supervised",
                             percent_better(kRefined),
                             percent_better(kSupervisedRefined)),
                       above("supervised over the neural adjoint",
                             percent_better(kSupervisedRefined),
                             percent_better(kAdjointRefined))})},
    {.id = "P9",
     .where = "Table 3",
     .says = "Share of the decrease that the network makes",
     .conditions = table3(kSeeds),
     .cause = differs("the network's share of the decrease, %: 88 to 92, 93 to "
                      "94, 92 to 93 and 96 at n = 4, 8, 32 and 128, printed "
                      "are 93.4, 96.2, 96.0 and 95.9; 32 falls short",
                      {above("lowest share of any n",
                             lowest_mean(kRefined, decrease_before()),
                             0.5)})}};

/// App. D.3: supervised learning and the neural adjoint.
const std::vector<Claim> kOthers = {
    {.id = "P10",
     .where = "App. D.3",
     .says =
         "Supervised learning gains with n: unrefined never better than BFGS "
         "at n = 2 and in around 20 % for n >= 64, refined in 50 and 62 %",
     .conditions = {as_stated("better at n = 2, %",
                              percent_better(at(kSupervised, 2)),
                              0,
                              kSeeds),
                    about("for n >= 64",
                          percent_better(kSupervised.of_sizes(64)),
                          20),
                    as_printed("refined at n = 2",
                               percent_better(at(kSupervisedRefined, 2)),
                               "text/supervised/refined/n=2",
                               kSeeds),
                    as_printed("refined for n >= 64",
                               percent_better(kSupervisedRefined.of_sizes(64)),
                               "text/supervised/refined/n>=64",
                               kSeeds)},
     .cause =
         differs("supervised learning is better in 14 % for n >= 64, around 20 "
                 "are printed, refined in 57 %, printed 62; it gains with n",
                 {above("refined, n >= 64 over n = 2, %",
                        percent_better(kSupervisedRefined.of_sizes(64)),
                        percent_better(at(kSupervisedRefined, 2)))})},
    {.id = "P11",
     .where = "App. D.3",
     .says = "The neural adjoint fails to match BFGS even when refined",
     .conditions = {either(
         below("solved",
               solved_share(kAdjointRefined, kSolved),
               solved_share(bfgs(), kSolved)),
         above("mean L",
               mean(kAdjointRefined, of_row(losses(), mean_of)),
               mean(bfgs(), of_row(losses(), mean_of))))},
     .note = "Of all n together.",
     .cause = contradiction(
         "App. D.3 says that it fails to match BFGS, Table 5 has it better in "
         "23.9 % and equal in 62.2 %: f = 0.55",
         {above("printed better and half of equal, %",
                difference(printed("table5/na/better"),
                           times(-0.5, printed("table5/na/equal"))),
                50)})},
    {.id = "P12",
     .where = "App. D.3",
     .says = "A handful of simulations from supervised learning and the neural "
             "adjoint diverge",
     .conditions = {reported("share of supervised", diverged(kSupervised)),
                    reported("of the neural adjoint", diverged(kAdjoint))},
     .cause = reported("a handful is no number")}};

// ---- the ranges
// ---------------------------------------------------------------

const std::vector<Claim> kRangesOfSolvers = {
    {.id = "R2",
     .says = "BFGS from (1, 1) solves most problems within few iterations",
     .conditions =
         {within("share solved", solved_of(64, bfgs()), 0.50, 0.78),
          within("median iterations of those",
                 median_of_examples(
                     bfgs(),
                     largest_sets(where(is_solved(kSolved), iterations()))),
                 8,
                 16),
          below("their highest L",
                highest(bfgs(),
                        largest_sets(of_row(where(is_solved(kSolved), losses()),
                                            most_of))),
                1e-18),
          reported("problems", problem_count(bfgs()))}},
    {.id = "R3",
     .says = "For n >= 32, 100 iterations of gradient descent solve about as "
             "many problems as BFGS but end above it on most",
     .conditions = {within("share solved less that of BFGS",
                           mean(gd().of_sizes(kMany), gain(kSolved)),
                           -0.07,
                           0.32),
                    within("f", mean(gd().of_sizes(kMany), f()), 0.09, 0.47)},
     .note = "Tolerance intervals: 90 % of all seeds with 95 % confidence, "
             "from 48 seeds of n = 32."}};

const Select kManyJpo = kJpo.of_sizes(kMany),
             kManyRefined = kRefined.of_sizes(kMany);

const std::vector<Claim> kRangesOfNetworks = {
    {.id = "R4",
     .says = "For n >= 32, refined JPO solves more problems than BFGS and is "
             "better on most, and refinement takes no more iterations",
     .conditions =
         {within("solved, refined",
                 from_at_least(3, mean(kManyRefined, solved(kSolved))),
                 0.60,
                 0.95),
          at_least("more than BFGS by",
                   from_at_least(3, mean(kManyRefined, gain(kSolved))),
                   0.05),
          within("better, refined", mean(kManyRefined, better()), 0.55, 0.85),
          within("better, unrefined", mean(kManyJpo, better()), 0.15, 0.55),
          at_most("median iterations of the refinement",
                  median_of_examples(kManyRefined, iterations()),
                  8),
          at_most("the same, BFGS's",
                  median_of_examples(kManyRefined, iterations()),
                  median_of_examples(bfgs().of_sizes(kMany), iterations()))}},
    {.id = "R5",
     .says = "For n >= 32, unrefined JPO stagnates far above machine precision",
     .conditions =
         {below("median L", median_of_examples(kManyJpo, losses()), 1e-1),
          above("median L", median_of_examples(kManyJpo, losses()), 1e-12),
          reported("solved without refinement at n <= 4",
                   solved_share(kJpo.of_sizes(0, 4), kSolved))}},
    {.id = "R6",
     .says = "For n >= 8 the network makes nearly all of the decrease",
     .conditions = {at_least(
         "lowest share of the decrease",
         lowest_mean(kRefined.of_sizes(8), decrease_before()),
         0.85)}},
    {.id = "R6b",
     .from = "paper",
     .says = "Refined JPO is no worse at n = 128 than at n = 4",
     .conditions = {at_least(
         "f at n = 128 over n = 4",
         difference(mean(at(kRefined, 128), f()), mean(at(kRefined, 4), f())),
         -0.1)}},
    {.id = "R7",
     .says = "For n >= 16, unrefined supervised learning is better than BFGS "
             "less often than JPO and the neural adjoint rarely; refined, many "
             "of the latter's solutions are BFGS's",
     .conditions = {
         better_more_often("better: jpo over supervised",
                           kJpo.of_sizes(16),
                           kSupervised.of_sizes(16)),
         at_most("better: na", mean(kAdjoint.of_sizes(16), better()), 0.2),
         at_least("equal: na refined",
                  mean(kAdjointRefined.of_sizes(16), equal()),
                  0.3)}}};

}  // namespace

void add_claims(Registry& r) {
  for (const auto& claims : {kSolvers,
                             kJoint,
                             kTables,
                             kOthers,
                             kRangesOfSolvers,
                             kRangesOfNetworks})
    r.add_claims("jpo/kuramoto-sivashinsky", claims);
}

}  // namespace physinv::jpo::kuramoto_sivashinsky
