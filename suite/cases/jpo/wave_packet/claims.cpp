// What the JPO paper says about wave packets (Sec. 4, Fig. 3, App. D.1), and
// the ranges that independent programs showed.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "problems/wave_packet/wave_packet.h"
#include "suite/cases/jpo/common/values.h"
#include "suite/cases/jpo/wave_packet/quantities.h"
#include "suite/harness/registry.h"

namespace physinv::jpo::wave_packet {
namespace {

constexpr const char* kName = "jpo/wave-packet";
constexpr double kBasin = 1;       // of the global optimum, in samples
constexpr Index kSeeds = 5;        ///< the paper's
constexpr double kLargeStep = 20;  // samples
const double kScale = WavePacketOptions{}.scale;
/// Between minima of the loss.
const double kPeriod = 2 * std::numbers::pi / WavePacketOptions{}.frequency;

/// In samples.
const RunRow distances = distances_in(kScale),
             first_steps = first_steps_in(kScale),
             farther_than_bfgs = farther_than_bfgs_in(kScale);

/// Distance of one guess for all, the middle of the window.
std::vector<double> distances_of_guess(const Run& run) {
  const auto truth = run.record->data.x.row(0);
  const double middle = 0.5 * (truth.minCoeff() + truth.maxCoeff());
  std::vector<double> out;
  for (Index i = 0; i < truth.size(); ++i)
    out.push_back(kScale * std::abs(truth(i) - middle));
  return out;
}

/// 1 where a path that is kept ends nearer to the truth than it started.
std::vector<double> approached(const Run& run) {
  const auto first = first_tracked(0)(run), last = last_tracked(0)(run);
  std::vector<double> flags;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double truth = run.record->data.x(0, static_cast<Index>(i));
    flags.push_back(std::abs(last[i] - truth) < std::abs(first[i] - truth));
  }
  return flags;
}

/// Of the paths that are kept: the first measured iteration from which on they
/// stay in the minimum where they end.
std::vector<double> settled(const Run& run) {
  const Curve& curve = run.stage->curve;
  std::vector<double> out;
  for (Index i = 0; i < curve.x.rows(); ++i) {
    Index k = curve.points() - 1;
    const double end = curve.x(i, k);
    while (k > 0 && kScale * std::abs(curve.x(i, k - 1) - end) < kPeriod / 2)
      --k;
    out.push_back(curve.iteration[static_cast<std::size_t>(k)]);
  }
  return out;
}

/// Over different problems, of which a claim needs enough.
Quantity pool_share(const Select& runs,
                    const RunRow& row,
                    std::function<bool(double)> test) {
  return from_problems(
      256, runs, share_of_examples(runs, largest_sets(row), std::move(test)));
}
Quantity pool_median(const Select& runs, const RunRow& row) {
  return from_problems(256, runs, median_of_examples(runs, largest_sets(row)));
}

bool misses(double distance) { return distance > kBasin; }
/// Of JPO, over more than a few of the paper's n and seeds.
Quantity of_many_sets(const RunRow& row) {
  return from_at_least(20, median_of_examples(kJpo, row));
}

const auto kProblem = problem<WavePacket>("wave_packet");

/// Tables 3 to 5.
const std::vector<Claim> kTables = {
    {.id = "P1",
     .where = "Sec. 4, Table 4",
     .says = "JPO is better than BFGS in around 80 % of examples",
     .conditions = table4("jpo", kSeeds)},
    {.id = "P2",
     .where = "Table 4",
     .says = "How often supervised learning and the neural adjoint are better "
             "than BFGS, and equal",
     .conditions = joined({table4("supervised", kSeeds), table4("na", kSeeds)}),
     .cause = depends("waveform and number of samples are not printed: with as "
                      "many as problems and a width of 1 supervised learning "
                      "is better in 30 %, with eight times as many and 0.25 it "
                      "was in 56 to 78 % (two runs), printed are 55.9; the "
                      "neural adjoint's 16 %, printed 28.2, stays open")},
    {.id = "P3",
     .where = "Table 5",
     .says = "How often refined JPO is better than BFGS, and equal",
     .conditions = table5("jpo", kSeeds)},
    {.id = "P4",
     .where = "Table 5",
     .says = "The same of refined supervised learning and neural adjoint",
     .conditions = joined({table5("supervised", kSeeds), table5("na", kSeeds)}),
     .cause = depends("precision and scale are not printed: in double, at a "
                      "scale of 128, refined supervised learning ties in 2 %; "
                      "in float, at 8, 3 to 16 % tied, printed are 14.4")},
    {.id = "P5",
     .where = "Table 3",
     .says = "Share of the decrease that the network makes",
     .conditions = table3(kSeeds)}};

/// Sec. 4: BFGS and gradient descent.
const std::vector<Claim> kSolvers = {
    {.id = "P6",
     .where = "Sec. 4",
     .says = "BFGS and gradient descent often end in local minima",
     .conditions = {at_least(
                        "BFGS", pool_share(bfgs(), distances, misses), 0.2),
                    at_least("gradient descent",
                             pool_share(gd(), distances, misses),
                             0.2)}},
    {.id = "P7",
     .where = "Sec. 4",
     .says = "BFGS usually takes a large first step and then converges "
             "quickly; gradient descent needs more iterations",
     .conditions = {above("first steps of BFGS that leave the basin",
                          pool_share(bfgs(),
                                     first_steps,
                                     [](double d) { return d > kPeriod; }),
                          0.5),
                    above("median iterations of gradient descent over BFGS",
                          pool_median(gd(), iterations()),
                          pool_median(bfgs(), iterations()))},
     .cause = depends(
         "unit of t0 and rule are not printed: where 128 samples are one, "
         "gradient descent takes 0.4 of the iterations of BFGS, where 8 are "
         "1.8 times as many, and a bold driver 3.6 and 4.2 times as many")},
    {.id = "P8",
     .where = "Sec. 4",
     .says = "Gradient descent comes closer to the global optimum more often",
     .conditions = {above(
         "closer than BFGS, over farther",
         pool_share(gd(), farther_than_bfgs, [](double d) { return d < 0; }),
         pool_share(gd(), farther_than_bfgs, [](double d) { return d > 0; }))},
     .cause = depends("unit of t0, rule and first step are not printed: at 128 "
                      "and 0.1 gradient descent is closer on 24 % of the "
                      "problems, at 8 and 0.1 on 51 %, at 128 and 1e-4 on 79 "
                      "%, by a bold driver on 83 % (768 problems)")}};

/// Sec. 4: JPO.
const std::vector<Claim> kJoint = {
    {.id = "P9",
     .where = "Sec. 4",
     .says = "JPO moves from minimum to minimum until it settles after 500 to "
             "3000 iterations",
     .conditions = {within(
         "median iteration of the last change",
         from_at_least(5, median_of_examples({"jpo-long", "fit"}, settled)),
         500,
         3000)},
     .note =
         "Fits of twice as many iterations; the four problems of each whose "
         "paths are kept, measured every seventh part of an iteration number.",
     .cause = fails(
         "in fits of twice the length the last change of minimum comes after "
         "4,587 iterations in the median, printed are 500 to 3,000; four paths "
         "a run, the grid of their points is a seventh")},
    {.id = "P10",
     .where = "Sec. 4",
     .says = "Many examples of JPO miss the global optimum, but none moves far "
             "away",
     .conditions = {at_least("share that misses it",
                             share_of_examples(kJpo, distances, misses),
                             0.2),
                    below("median |t0 - truth|, over BFGS's",
                          of_many_sets(distances),
                          median_of_examples(bfgs(), distances)),
                    below("over that of one guess for all",
                          of_many_sets(distances),
                          of_many_sets(distances_of_guess))},
     .note = "Of all n together; with n = 8 to 32 alone, estimates lie as far "
             "away as one guess for all."}};

const Select kAdjoint256 = at(kAdjointRefined, 256);

/// App. D.1: supervised learning and the neural adjoint.
const std::vector<Claim> kOthers = {
    {.id = "P11",
     .where = "App. D.1",
     .says = "With supervised learning all estimates approach the truth while "
             "the total loss rises",
     .conditions = {at_least("share that ends nearer than it started",
                             share_of_examples(kSupervised, approached, holds),
                             0.9),
                    above("mean L at the end over the start",
                          mean(kSupervised, of_row(losses(), mean_of)),
                          mean(kSupervised, of_row(start_losses(), mean_of)))},
     .note = "Paths are kept of four problems of each run.",
     .cause =
         fails("66 % of the estimates approach the truth, all are printed; "
               "number and spread of the samples are not printed")},
    {.id = "P12",
     .where = "App. D.1",
     .says = "At n = 256 the refined neural adjoint is better in about a "
             "third; many estimates get stuck at the boundary",
     .conditions =
         {either(within("better, %", percent_better(kAdjoint256), 28, 38),
                 as_printed("better, %",
                            percent_better(kAdjoint256),
                            "text/na/better/n=256",
                            kSeeds)),
          at_least(
              "share of ends at or beyond the boundary",
              share_of_examples(
                  at(kAdjoint, 256), beyond_training(kProblem, 0.02), holds),
              0.2)},
     .note = "Ends of the four problems of each run whose paths are kept.",
     .cause = fails("no estimate ends at the boundary; sharpness and weight of "
                    "the wall are not printed, and others were not tried here; "
                    "better in 29.5 %, as printed")}};

// ---- the ranges
// ---------------------------------------------------------------

const Select kLarge = kJpo.of_sizes(32);
const Quantity kF = from_at_least(3, mean(kLarge, f())),
               kRefinedF = from_at_least(3, mean(kRefined.of_sizes(32), f()));

const std::vector<Claim> kRangesOfJoint = {
    {.id = "R2",
     .says = "For n >= 32, JPO beats BFGS on most problems, more often than "
             "supervised learning and the neural adjoint, and refinement keeps "
             "that",
     .conditions = {
         within("f(JPO)", kF, 0.60, 0.92),
         within("f(JPO refined)", kRefinedF, 0.65, 0.97),
         at_least("refined - not", difference(kRefinedF, kF), -0.02),
         better_more_often(
             "better: jpo over supervised", kLarge, kSupervised.of_sizes(32)),
         better_more_often(
             "better: jpo over na", kLarge, kAdjoint.of_sizes(32))}}};

const std::vector<Claim> kRangesOfSolvers = {
    {.id = "R3a",
     .from = "smoke",
     .says = "BFGS takes a large first step, then converges to the nearest "
             "optimum within few iterations",
     .conditions =
         {at_most("median iterations", pool_median(bfgs(), iterations()), 10),
          at_least(
              "share with a first step > 20 samples",
              pool_share(
                  bfgs(), first_steps, [](double d) { return d > kLargeStep; }),
              0.5)}},
    {.id = "R3b",
     .says = "For n >= 32, gradient descent is about as good as BFGS or better",
     .conditions = {at_least(
         "f(gradient descent)", mean(gd().of_sizes(32), f()), 0.45)}},
    {.id = "R4",
     .from = "smoke",
     .says = "BFGS rarely finds the global basin",
     .conditions = {below(
         "share with |t0 - truth| < 1",
         pool_share(bfgs(), distances, [](double d) { return d < kBasin; }),
         0.15)}}};

const std::vector<Claim> kRangesOfRefinement = {
    {.id = "R5",
     .says = "Refinement never increases a loss; it makes supervised learning "
             "better, and equal solutions at least as common with the neural "
             "adjoint as with JPO",
     .conditions = {at_most("losses increased",
                            most({highest(kRefined, worsened()),
                                  highest(kSupervisedRefined, worsened()),
                                  highest(kAdjointRefined, worsened())}),
                            0),
                    above("f(supervised): refined over not",
                          mean(kSupervisedRefined, f()),
                          mean(kSupervised, f())),
                    at_least("equal, refined: na over jpo",
                             mean(kAdjointRefined, equal()),
                             mean(kRefined, equal()))}},
    {.id = "R6",
     .says = "For n >= 8, the network makes most of JPO's decrease",
     .conditions = {
         at_least("lowest mean of any n",
                  lowest_mean(kRefined.of_sizes(8), decrease_before()),
                  0.7)}}};

const std::vector<Claim> kRangesOfOthers = {
    {.id = "T4",
     .says = "Supervised learning and the neural adjoint beat BFGS about as "
             "often as Table 4 prints; this hangs on the waveform, which the "
             "paper shows only as a picture",
     .conditions =
         {within(
              "better: supervised", mean(kSupervised, better()), 0.459, 0.659),
          within("better: na", mean(kAdjoint, better()), 0.182, 0.382)},
     .cause = fails("Table 4 prints 55.9 and 28.2 %, ours are 30 and 16 (P2)"),
     .gates = false}};

}  // namespace

void add_claims(Registry& r) {
  for (const auto& claims : {kTables,
                             kSolvers,
                             kJoint,
                             kOthers,
                             kRangesOfJoint,
                             kRangesOfSolvers,
                             kRangesOfRefinement,
                             kRangesOfOthers})
    r.add_claims(kName, claims);
}

}  // namespace physinv::jpo::wave_packet
