// JPO paper, Sec. 4 "Kuramoto-Sivashinsky equation", Fig. 5, App. D.3: a
// chaotic solver whose gradients mislead one problem at a time, but not a
// network that sees many.
#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "suite/cases/jpo_claims.h"
#include "suite/cases/jpo_endings.h"
#include "suite/cases/jpo_methods.h"
#include "suite/cases/jpo_report.h"
#include "suite/harness/registry.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv {
namespace {

constexpr const char* kName = "jpo/kuramoto-sivashinsky";
constexpr Index kFitIterations = 1000;
/// From here on the paper's statements hold; small sets can be memorised.
constexpr Index kMany = 32;
constexpr Index kEvery = std::numeric_limits<Index>::max();

const auto kTrained = trained_methods();
const KuramotoSivashinskyOptions kPhysics;
const nn::VggOptions kPredictor{.channels = 2,
                                .grid = {.columns = 128},
                                .features = {32, 32, 64, 64},
                                .hidden = {64, 64}};

Solved solved() { return within_of_truth(1e-3); }

std::optional<double> better(const JpoMetrics& metrics,
                             const char* method,
                             Index first,
                             bool refined) {
  return better_of(metrics.mean_shares(method,
                                       sizes_between(metrics, first, kEvery),
                                       refined,
                                       Equality::strict));
}

/// Plain BFGS on all problems of the largest n.
struct BfgsRuns {
  Index problems = 0;
  std::vector<double> iterations, losses;  ///< of the solved ones

  double share() const {
    return static_cast<double>(losses.size()) / static_cast<double>(problems);
  }
};

BfgsRuns bfgs_runs(const Results& results, const JpoMetrics& metrics) {
  BfgsRuns runs;
  const Solved is_solved = solved();
  const auto sizes = metrics.sizes();
  if (sizes.empty()) return runs;
  for (const std::uint64_t seed : metrics.seeds()) {
    const auto* stage = metrics.stage("bfgs", sizes.back(), seed, "solve");
    if (stage == nullptr) continue;
    const CaseData& data =
        results.find_case(kName, "bfgs", sizes.back(), seed)->data;
    for (Index i = 0; i < stage->loss.size(); ++i) {
      ++runs.problems;
      if (!is_solved(data, *stage, i)) continue;
      runs.iterations.push_back(stage->example_iterations(i));
      runs.losses.push_back(stage->loss(i));
    }
  }
  return runs;
}

ClaimResult bfgs_is_trapped(const Results& results, const JpoMetrics& metrics) {
  const BfgsRuns runs = bfgs_runs(results, metrics);
  Judge judge;
  if (runs.problems < 64 || runs.losses.empty()) {
    judge.missing("BFGS on 64 problems of one n");
  } else {
    judge.at_least("share solved", runs.share(), 0.50)
        .at_most("share solved", runs.share(), 0.78)
        .at_least("median iterations of those", median(runs.iterations), 8)
        .at_most("median iterations of those", median(runs.iterations), 16)
        .below("their highest L",
               *std::max_element(runs.losses.begin(), runs.losses.end()),
               1e-18)
        .report("problems", static_cast<double>(runs.problems));
  }
  return std::move(judge).result(
      "R2",
      "BFGS from (1, 1) solves 50 to 78 % of at least 64 problems, in a median "
      "of 8 to 16 iterations and to L < 1e-18",
      "quick");
}

ClaimResult descent_is_no_better(const JpoMetrics& metrics) {
  const auto sizes = sizes_between(metrics, kMany, kEvery);
  const auto share = [&](const char* method) {
    return metrics.pooled_solved_share(method, sizes, false, solved());
  };
  const auto bfgs = share("bfgs");
  const auto f = metrics.mean_shares("gd", sizes, false, Equality::strict);
  Judge judge;
  if (!bfgs) {
    judge.missing("BFGS for n >= 32");
  } else {
    judge.at_most("share solved, BFGS's + 0.05", share("gd"), *bfgs + 0.05);
  }
  judge.below("f", f ? std::optional(f->mean.f()) : std::nullopt, 0.35);
  return std::move(judge).result(
      "R3",
      "For n >= 32, 100 iterations of gradient descent solve no more problems "
      "than BFGS (+ 0.05), and f(GD) < 0.35",
      "quick");
}

/// Mean over all n >= 32 and seeds of the share that refined JPO solves, and
/// of what it solves beyond BFGS. Nothing with fewer than three seeds.
struct Solves {
  double share = 0, gain = 0;
};
std::optional<Solves> jpo_solves(const JpoMetrics& metrics) {
  Solves sum;
  Index pairs = 0;
  for (const Index n : sizes_between(metrics, kMany, kEvery)) {
    for (const std::uint64_t seed : metrics.seeds()) {
      const auto jpo = metrics.solved_share("jpo", n, seed, true, solved());
      const auto bfgs = metrics.solved_share("bfgs", n, seed, false, solved());
      if (!jpo || !bfgs) continue;
      sum.share += *jpo, sum.gain += *jpo - *bfgs;
      ++pairs;
    }
  }
  if (pairs == 0 || metrics.seeds().size() < 3) return {};
  const auto count = static_cast<double>(pairs);
  return Solves{sum.share / count, sum.gain / count};
}

ClaimResult jpo_solves_more(const JpoMetrics& metrics) {
  const auto solves = jpo_solves(metrics);
  const auto refined = better(metrics, "jpo", kMany, true);
  const auto unrefined = better(metrics, "jpo", kMany, false);
  const auto refinement =
      Endings(metrics, "jpo", true, kMany).median_iterations();
  const auto bfgs = Endings(metrics, "bfgs", false, kMany).median_iterations();
  Judge judge;
  if (!solves) {
    judge.missing("JPO and BFGS with three seeds");
  } else {
    judge.at_least("solved, refined", solves->share, 0.60)
        .at_most("solved, refined", solves->share, 0.95)
        .at_least("more than BFGS by", solves->gain, 0.05);
  }
  judge.at_least("better, refined", refined, 0.55)
      .at_most("better, refined", refined, 0.85)
      .at_least("better, unrefined", unrefined, 0.15)
      .at_most("better, unrefined", unrefined, 0.55)
      .at_most("median iterations of the refinement", refinement, 8);
  if (bfgs) {
    judge.at_most("the same, BFGS's", refinement, *bfgs);
  } else {
    judge.missing("median iterations of BFGS");
  }
  return std::move(judge).result(
      "R4",
      "For n >= 32, refined JPO solves more problems than BFGS (by 0.05, mean "
      "over at least 3 seeds), is better on 55 to 85 % (unrefined 15 to 55 %), "
      "and refinement takes at most 8 iterations and no more than BFGS",
      "quick");
}

ClaimResult networks_stagnate(const JpoMetrics& metrics) {
  const auto losses =
      Endings(metrics, "jpo", false, kMany).all(&StageRecord::loss);
  const auto middle =
      losses.empty() ? std::nullopt : std::optional(median(losses));
  Judge judge;
  judge.below("median L", middle, 1e-1).above("median L", middle, 1e-12);
  const auto at = sizes_between(metrics, 0, 4);
  judge.report("solved without refinement at n <= 4",
               metrics.pooled_solved_share("jpo", at, false, solved()));
  return std::move(judge).result(
      "R5",
      "For n >= 32, unrefined JPO stagnates far above machine precision: "
      "median L in (1e-12, 1e-1)",
      "quick");
}

ClaimResult network_makes_the_decrease(const JpoMetrics& metrics, bool full) {
  std::optional<double> lowest;
  for (const Index n : sizes_between(metrics, 8, kEvery)) {
    if (const auto mean = metrics.share_of_decrease("jpo", n))
      lowest = std::min(lowest.value_or(*mean), *mean);
  }
  const auto f = [&](Index n) {
    return f_of(
        metrics.mean_shares("jpo", std::vector{n}, true, Equality::strict));
  };
  Judge judge;
  judge.at_least("lowest share of the decrease, n >= 8", lowest, 0.85);
  if (full) {
    const auto few = f(4);
    if (few) {
      judge.at_least(
          "f refined at n=128, that at n=4 - 0.1", f(128), *few - 0.1);
    } else {
      judge.missing("f at n=4");
    }
  }
  return std::move(judge).result(
      "R6",
      full ? "For n >= 8 the network makes at least 85 % of the decrease, and "
             "refined JPO is no worse at n = 128 than at n = 4 (f - 0.1)"
           : "For n >= 8 the network makes at least 85 % of the decrease",
      "quick");
}

ClaimResult samples_teach_less(const JpoMetrics& metrics) {
  constexpr Index kFirst = 16;
  const auto jpo = better(metrics, "jpo", kFirst, false);
  const auto supervised = better(metrics, "supervised", kFirst, false);
  const auto na = metrics.mean_shares(
      "na", sizes_between(metrics, kFirst, kEvery), true, Equality::strict);
  Judge judge;
  judge.above("better: jpo over supervised", jpo, supervised)
      .at_most("better: na", better(metrics, "na", kFirst, false), 0.2)
      .at_least("equal: na refined", equal_of(na), 0.3);
  return std::move(judge).result(
      "R7",
      "For n >= 16, unrefined supervised learning is better than BFGS less "
      "often than JPO and the neural adjoint at most 20 % of the time; "
      "refined, at least 30 % of the latter's solutions are BFGS's",
      "quick");
}

// ---- what the paper says in words -----------------------------------------

/// Lowest and highest mean number of iterations of any n.
std::optional<std::pair<double, double>> iterations_over_n(
    const JpoMetrics& metrics, const char* method, bool refined) {
  std::optional<std::pair<double, double>> range;
  for (const Index n : metrics.sizes()) {
    std::vector<double> means;
    for (const std::uint64_t seed : metrics.seeds())
      if (const auto* end = metrics.ending(method, n, seed, refined))
        means.push_back(end->example_iterations.mean());
    const auto mean = mean_std(means);
    if (!mean) continue;
    if (!range) range = {mean->mean, mean->mean};
    range->first = std::min(range->first, mean->mean);
    range->second = std::max(range->second, mean->mean);
  }
  return range;
}

Table in_words(const JpoMetrics& metrics, const Published& published) {
  Table table{.id = "text",
              .title = "Numbers of the text",
              .source = "Sec. 4, App. D.3",
              .digits = 1,
              .columns = {"value"},
              .note =
                  "Solved: both unknowns within 1e-3. Iterations: lowest and "
                  "highest mean of any n. Better: than BFGS."};
  const auto add =
      [&](const char* label, const char* quantity, std::optional<double> ours) {
        Cell cell{.ours = ours};
        if (const auto found = published.find(kName, quantity))
          cell.paper = found->value;
        if (!ours) cell.text = "not run";
        table.rows.push_back({label, {cell}});
      };
  const auto percent = [](std::optional<double> share) {
    return share ? std::optional(100 * *share) : std::nullopt;
  };
  const auto solved_by = [&](const char* method, bool refined) {
    return percent(metrics.pooled_solved_share(
        method, sizes_between(metrics, kMany, kEvery), refined, solved()));
  };
  const auto better_at =
      [&](const char* method, bool refined, Index first, Index last) {
        return percent(
            better_of(metrics.mean_shares(method,
                                          sizes_between(metrics, first, last),
                                          refined,
                                          Equality::strict)));
      };
  add("BFGS solves, n >= 32, %", "text/bfgs/solved", solved_by("bfgs", false));
  add("JPO refined solves, n >= 32, %",
      "text/jpo/solved",
      solved_by("jpo", true));
  const auto bfgs = iterations_over_n(metrics, "bfgs", false);
  const auto refine = iterations_over_n(metrics, "jpo", true);
  using Range = std::optional<std::pair<double, double>>;
  const auto low = [](const Range& r) {
    return r ? std::optional(r->first) : std::nullopt;
  };
  const auto high = [](const Range& r) {
    return r ? std::optional(r->second) : std::nullopt;
  };
  add("BFGS iterations, lowest", "text/bfgs/iterations_low", low(bfgs));
  add("BFGS iterations, highest", "text/bfgs/iterations_high", high(bfgs));
  add("refinement iterations, lowest", "text/jpo/iterations_low", low(refine));
  add("refinement iterations, highest",
      "text/jpo/iterations_high",
      high(refine));
  add("JPO refined better, n = 256, %",
      "text/jpo/better/n=256",
      better_at("jpo", true, 256, 256));
  add("supervised refined better, %",
      "text/supervised/refined",
      better_at("supervised", true, 0, kEvery));
  add("supervised refined better, n = 2, %",
      "text/supervised/refined/n=2",
      better_at("supervised", true, 2, 2));
  add("supervised refined better, n >= 64, %",
      "text/supervised/refined/n>=64",
      better_at("supervised", true, 64, kEvery));
  add("supervised better, n = 2, %",
      "text/supervised/better/n=2",
      better_at("supervised", false, 2, 2));
  add("supervised better, n >= 64, %",
      "text/supervised/better/n>=64",
      better_at("supervised", false, 64, kEvery));
  return table;
}

// ---- figures of the paper that no other experiment has --------------------

/// The first problem of seed 0.
Samples<double> example(const KuramotoSivashinsky<double>& physics) {
  return physics.sample(0, 1, Rng::root(kName, 0).child("data/test"));
}

/// Fig. 5a: one trajectory.
Figure trajectory() {
  const KuramotoSivashinsky<double> physics(kPhysics);
  const Samples<double> s = example(physics);
  const Batch<double> u = physics.trajectory(s.x.col(0), s.given.col(0));
  Field2D field{.label = "u"};
  for (Index k = 0; k < u.cols(); ++k)
    field.x.push_back(static_cast<double>(k) * kPhysics.time_step);
  for (Index j = 0; j < u.rows(); ++j) {
    field.y.push_back((static_cast<double>(j) + 0.5) * kPhysics.box /
                      static_cast<double>(kPhysics.cells));
    for (Index k = 0; k < u.cols(); ++k) field.values.push_back(u(j, k));
  }
  return {
      .id = "fig5a",
      .title = "A trajectory u(x, t)",
      .source = "Fig. 5a",
      .panels = {{.x_label = "t", .y_label = "x", .field = std::move(field)}},
      .columns = 1,
      .note = fmt::format("Problem 0 of seed 0: alpha = {:.3f}, beta = "
                          "{:.3f}.",
                          s.x(0, 0),
                          s.x(1, 0))};
}

/// Fig. 5b: the loss over beta at the true alpha.
Figure landscape() {
  constexpr Index kPoints = 401;
  const KuramotoSivashinsky<double> physics(kPhysics);
  const Samples<double> s = example(physics);
  Batch<double> x(2, kPoints), y(s.y.rows(), kPoints);
  x.row(0).setConstant(s.x(0, 0));
  x.row(1).setLinSpaced(0.5, 1.5);
  Vector<double> loss(kPoints);
  Workspace work;
  physics.forward(x, s.given.replicate(1, kPoints).eval(), y, work);
  physics.loss(y, s.y.replicate(1, kPoints).eval(), loss);
  return {
      .id = "fig5b",
      .title = "Loss over beta at the true alpha",
      .source = "Fig. 5b",
      .panels = {{.x_label = "beta",
                  .y_label = "loss",
                  .series = {{.method = "bfgs",
                              .x = {x.row(1).begin(), x.row(1).end()},
                              .y = {loss.begin(), loss.end()}},
                             {.label = "solution",
                              .method = "truth",
                              .x = {s.x(1, 0)},
                              .y = {0},
                              .line = false,
                              .markers = true}}}},
      .columns = 1,
      .note = fmt::format("Problem 0 of seed 0, alpha = {:.3f}.", s.x(0, 0))};
}

/// Names of the predictor's tensors, in the order of the records.
std::vector<std::string> tensors() {
  std::vector<std::string> names;
  const auto net =
      nn::vgg(kPredictor)
          .make<float>(kPredictor.channels * kPredictor.grid.positions(), 2);
  for (const TensorInfo& t : net->tensors()) names.push_back(t.name);
  return names;
}

/// Fig. 5c: curves of one n, gradient descent among them.
Figure curves_with_descent(JpoReportOptions options,
                           const Results& results,
                           const Published& published) {
  const JpoMetrics metrics(results, options.experiment);
  const auto sizes = metrics.sizes();
  options.methods.insert(options.methods.begin(), "gd");
  options.curves = {"fig5c", "Fig. 5c"};
  if (!sizes.empty()) options.curve_sizes = {sizes.back()};
  Figure figure = JpoReport(options, results, published).curves();
  figure.columns = 1;
  return figure;
}

Section report(const Results& results, const Published& published) {
  const JpoReportOptions options{.experiment = kName,
                                 .title = "Kuramoto-Sivashinsky equation",
                                 .paper = "jpo",
                                 .solved = solved(),
                                 .trajectory_size = 128,
                                 .unknowns = {"alpha", "beta"},
                                 .tensors = tensors(),
                                 .fraction = {"fig5d", "Fig. 5d"},
                                 .improvement = {"fig15", "Fig. 15"},
                                 .curves = {"fig16", "Fig. 16"},
                                 .trajectories = {"fig17", "Fig. 17"},
                                 .weight_change = {"fig18", "Fig. 18"}};
  Section section = jpo_section(options, results, published);
  section.figures.insert(section.figures.begin(),
                         {trajectory(),
                          landscape(),
                          curves_with_descent(options, results, published)});
  const JpoMetrics metrics(results, kName);
  section.tables.push_back(in_words(metrics, published));
  const auto seen = metrics.sizes();
  const bool full = std::count(seen.begin(), seen.end(), 128) > 0;
  section.claims = {bfgs_is_trapped(results, metrics),
                    descent_is_no_better(metrics),
                    jpo_solves_more(metrics),
                    networks_stagnate(metrics),
                    network_makes_the_decrease(metrics, full),
                    samples_teach_less(metrics)};
  return section;
}

std::vector<std::uint64_t> seeds(std::uint64_t count) {
  std::vector<std::uint64_t> all;
  for (std::uint64_t s = 0; s < count; ++s) all.push_back(s);
  return all;
}

const std::vector<Index> kSizes = {2, 4, 8, 16, 32, 64, 128, 256};

const auto kRegistered = register_experiment({
    .name = kName,
    .title = "Kuramoto-Sivashinsky equation",
    .source = {.paper = "jpo", .where = "Sec. 4, Fig. 5, App. D.3"},
    .problem = problem<KuramotoSivashinsky>("kuramoto_sivashinsky", kPhysics),
    .setting = {.predictor = {{Field::given, Field::observations},
                              nn::vgg(kPredictor)},
                .surrogate = {{Field::given, Field::unknowns},
                              nn::unet({.grid = {.columns = 128},
                                        .channels = 1,
                                        .scalars_after = 2,
                                        .scalar_shift = 1,
                                        .scalar_unit = 0.25})},
                .output_scale = 0.25,
                .gtol = 1e-10},
    .profiles =
        {{.name = "smoke",
          .rows = {{.methods = {"bfgs"}, .n = {4}, .seeds = {0}},
                   {.methods = {"gd"}, .n = {4}, .seeds = {0}, .iterations = 5},
                   {.methods = kTrained,
                    .n = {4},
                    .seeds = {0},
                    .iterations = 20}}},
         {.name = "quick",
          .rows = {{.methods = {"bfgs", "gd"}, .n = {4, 32}, .seeds = seeds(3)},
                   {.methods = kTrained,
                    .n = {4, 32},
                    .seeds = seeds(3),
                    .iterations = 500}}},
         {.name = "paper",
          .rows = {{.methods = {"bfgs", "gd"}, .n = kSizes, .seeds = seeds(10)},
                   {.methods = kTrained,
                    .n = kSizes,
                    .seeds = seeds(10),
                    .iterations = kFitIterations}}}},
    .methods = jpo_methods({.rate = 1e-3,
                            .iterations = kFitIterations,
                            .bfgs_iterations = 200,
                            .descent_iterations = 100}),
    .report = report,
});

}  // namespace
}  // namespace physinv
