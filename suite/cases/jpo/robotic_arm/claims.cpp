// What the JPO paper says about the robotic arm (App. D.5), and the ranges
// that independent programs showed.
#include <algorithm>
#include <cmath>

#include "suite/cases/jpo/common/values.h"
#include "suite/evidence/statistics.h"
#include "suite/harness/registry.h"

namespace physinv::jpo::robotic_arm {
namespace {

constexpr double kSolved = 1e-12;

/// Of any n and seed.
Condition all_solved(std::string label,
                     const Select& runs,
                     double loss = kSolved) {
  return at_least(std::move(label), lowest(runs, solved(loss)), 1);
}
/// In iterations, or updates of a network.
Quantity median_to(double loss, const Select& runs) {
  return median_of_examples(runs, first_below(loss));
}
Quantity median_iterations(const Select& runs) {
  return median_of_examples(runs, iterations());
}
Quantity highest_loss(const Select& runs) {
  return highest(runs, of_row(losses(), most_of));
}
Quantity highest_mean_loss(const Select& runs) {
  return highest(runs, of_row(losses(), mean_of));
}

/// Of the targets that are missed: how far the tip would have to come in from
/// full stretch. 0 if there are none.
double slack_of_misses(const Run& run) {
  double slack = 0;
  for (Index i = 0; i < run.stage->loss.size(); ++i)
    if (!(run.stage->loss(i) < kSolved))
      slack = std::max(slack, 2 - std::abs(run.record->data.y(0, i)));
  return slack;
}

/// App. D.5: BFGS and gradient descent.
const std::vector<Claim> kSolvers = {
    {.id = "P1",
     .where = "App. D.5",
     .from = "quick",
     .says = "BFGS reaches machine precision within a couple of iterations",
     .conditions = {at_most("median iterations to L < 1e-12",
                            median_to(kSolved, at(bfgs(), 64)),
                            25)},
     .note = "A couple is read as 25. Curves are measured every seventh part "
             "of an iteration number."},
    {.id = "P2",
     .where = "App. D.5",
     .from = "quick",
     .says = "Gradient descent does, too",
     .conditions = {at_most("median iterations to L < 1e-12",
                            median_to(kSolved, at(gd(), 64)),
                            25)},
     .cause = depends(
         "which loss is machine precision is not printed: to 1e-12 gradient "
         "descent takes a median of 28 iterations, to 1e-9 25 or fewer",
         {at_most("median iterations to L < 1e-9",
                  median_to(1e-9, at(gd(), 64)),
                  25)})}};

/// App. D.5, Fig. 25: networks and their refinement.
const std::vector<Claim> kNetworks = {
    {.id = "P3",
     .where = "App. D.5, Fig. 25c",
     .from = "quick",
     .says = "The networks take longer to fit the data",
     .conditions = {above("median updates of JPO to L < 1e-4",
                          median_to(1e-4, kJpo),
                          median_to(1e-4, bfgs())),
                    above("of supervised learning",
                          median_to(1e-4, kSupervised),
                          median_to(1e-4, bfgs()))},
     .note = "Not finite: never. A surrogate has no estimate of its own while "
             "it is fitted, and is not compared."},
    {.id = "P4",
     .where = "App. D.5, Fig. 25d",
     .says = "Refined, all solutions of every n reach zero loss",
     .conditions = {all_solved("lowest share with L < 1e-12: jpo", kRefined),
                    all_solved("supervised", kSupervisedRefined),
                    all_solved("na", kAdjointRefined)}},
    {.id = "P5",
     .where = "Sec. 5, App. D.5",
     .says = "On convex problems JPO always reaches the optimum; classical "
             "optimizers solve them perfectly",
     .conditions = {all_solved("lowest share solved: JPO refined", kRefined),
                    all_solved("BFGS", bfgs()),
                    all_solved("gradient descent", gd())},
     .cause = depends(
         "which loss is machine precision is not printed: by 1e-12 gradient "
         "descent leaves two of 512 targets at the stretched arm, by 1e-8 none",
         {all_solved(
             "lowest share below 1e-8: gradient descent", gd(), 1e-8)})}};

// ---- the ranges
// ---------------------------------------------------------------

const std::vector<Claim> kRangesOfSolvers = {
    {.id = "R2",
     .from = "smoke",
     .says = "BFGS solves every problem of every n and seed, nearly all to "
             "rounding",
     .conditions =
         {all_solved("lowest share with L < 1e-12", bfgs()),
          within("median iterations", median_iterations(bfgs()), 6, 14),
          at_least("share with L <= 1e-18",
                   share_of_examples(
                       bfgs(), losses(), [](double l) { return l <= 1e-18; }),
                   0.95)}},
    {.id = "R3",
     .says = "Gradient descent solves nearly every problem, all but targets at "
             "full stretch, and needs more iterations than BFGS",
     .conditions = {at_least("share solved of all problems",
                             share_of_examples(
                                 gd(), largest_sets(if_solved(kSolved)), holds),
                             0.984),
                    within("median iterations of them",
                           median_of_examples(gd(), largest_sets(iterations())),
                           44,
                           64),
                    above("median iterations over those of BFGS",
                          median_iterations(gd()),
                          median_iterations(bfgs())),
                    reported(
                        "missed targets end before full stretch by at most",
                        highest(gd(), slack_of_misses))},
     .note = "Tolerance intervals: 90 % of all seeds with 95 % confidence, "
             "from 48 seeds of n = 128."}};

const std::vector<Claim> kRangesOfNetworks = {
    {.id = "R4",
     .says = "For n >= 8 and every seed, JPO ends close to the solution but "
             "far above BFGS; refined, it solves every problem",
     .conditions =
         {below("highest median L",
                highest(kJpo.of_sizes(8),
                        of_row(losses(),
                               [](auto v) { return median(std::move(v)); })),
                1e-5),
          at_least(
              "lowest mean L over BFGS's",
              lowest(kJpo.of_sizes(8), over_bfgs(of_row(losses(), mean_of))),
              1e3),
          all_solved("lowest share solved, refined", kRefined.of_sizes(8))}},
    {.id = "R5",
     .says = "Refined, supervised learning and the neural adjoint solve nearly "
             "all problems, and the mean loss of every method is a rounding "
             "error for every n",
     .conditions =
         {at_least("solved, refined: supervised",
                   solved_share(kSupervisedRefined, kSolved),
                   0.98),
          at_least("solved, refined: na",
                   solved_share(kAdjointRefined, kSolved),
                   0.98),
          below(
              "highest L/n, refined: jpo", highest_mean_loss(kRefined), 1e-12),
          below("supervised", highest_mean_loss(kSupervisedRefined), 1e-12),
          below("na", highest_mean_loss(kAdjointRefined), 1e-12)}},
    {.id = "R6",
     .says =
         "f against BFGS says nothing here: both losses are rounding errors",
     .conditions = {below("highest L: bfgs", highest_loss(bfgs()), kSolved),
                    below("refined: jpo", highest_loss(kRefined), kSolved),
                    below("supervised",
                          highest_loss(kSupervisedRefined),
                          kSolved),
                    below("na", highest_loss(kAdjointRefined), kSolved),
                    reported("f, refined: jpo", mean(kRefined, f())),
                    reported("supervised", mean(kSupervisedRefined, f())),
                    reported("na", mean(kAdjointRefined, f()))},
     .gates = false}};

}  // namespace

void add_claims(Registry& r) {
  for (const auto& claims :
       {kSolvers, kNetworks, kRangesOfSolvers, kRangesOfNetworks})
    r.add_claims("jpo/robotic-arm", claims);
}

}  // namespace physinv::jpo::robotic_arm
