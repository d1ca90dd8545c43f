#include "suite/cases/jpo/kuramoto_sivashinsky/claims.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "suite/cases/jpo/common/endings.h"

namespace physinv::ks {

Solved solved() { return within_of_truth(1e-3); }

std::optional<double> better(const JpoMetrics& metrics,
                             const char* method,
                             bool refined,
                             Index first,
                             Index last) {
  return better_of(metrics.mean_shares(
      method, sizes_between(metrics, first, last), refined));
}

namespace {

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
  const auto sizes = sizes_between(metrics, kMany);
  const auto share = [&](const char* method) {
    return metrics.pooled_solved_share(method, sizes, false, solved());
  };
  const auto bfgs = share("bfgs");
  const auto f = metrics.mean_shares("gd", sizes, false);
  Judge judge;
  if (!bfgs) {
    judge.missing("BFGS for n >= 32");
  } else {
    judge.at_most("share solved, BFGS's + 0.05", share("gd"), *bfgs + 0.05);
  }
  judge.below("f", f_of(f), 0.35);
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
  for (const Index n : sizes_between(metrics, kMany)) {
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
  const auto refined = better(metrics, "jpo", true, kMany);
  const auto unrefined = better(metrics, "jpo", false, kMany);
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
  for (const Index n : sizes_between(metrics, 8)) {
    if (const auto mean = metrics.share_of_decrease("jpo", n))
      lowest = std::min(lowest.value_or(*mean), *mean);
  }
  const auto f = [&](Index n) {
    return f_of(metrics.mean_shares("jpo", std::vector{n}, true));
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
  const auto jpo = better(metrics, "jpo", false, kFirst);
  const auto supervised = better(metrics, "supervised", false, kFirst);
  const auto na =
      metrics.mean_shares("na", sizes_between(metrics, kFirst), true);
  Judge judge;
  judge.above("better: jpo over supervised", jpo, supervised)
      .at_most("better: na", better(metrics, "na", false, kFirst), 0.2)
      .at_least("equal: na refined", equal_of(na), 0.3);
  return std::move(judge).result(
      "R7",
      "For n >= 16, unrefined supervised learning is better than BFGS less "
      "often than JPO and the neural adjoint at most 20 % of the time; "
      "refined, at least 30 % of the latter's solutions are BFGS's",
      "quick");
}

}  // namespace

std::vector<ClaimResult> claims(const Results& results) {
  const JpoMetrics metrics(results, kName);
  const auto seen = metrics.sizes();
  const bool full = std::count(seen.begin(), seen.end(), 128) > 0;
  return {bfgs_is_trapped(results, metrics),
          descent_is_no_better(metrics),
          jpo_solves_more(metrics),
          networks_stagnate(metrics),
          network_makes_the_decrease(metrics, full),
          samples_teach_less(metrics)};
}

}  // namespace physinv::ks
