/// How the methods of an experiment compare: ranks and paired tests of final
/// losses, expected running times, scores of performance profiles.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "suite/evidence/common_runs.h"
#include "suite/evidence/rank_test.h"
#include "suite/results/report_model.h"

namespace physinv {

/// Two methods on the same problems, the one of the lower mean rank first.
struct MethodPair {
  std::size_t first = 0, second = 0;
  SignedRank test;  ///< below: the first one is lower
  double p = 1;     ///< by Holm over all pairs
};

struct Standings {
  std::size_t problems = 0;
  std::vector<std::size_t> order;  ///< methods, lowest mean rank first
  std::vector<double> mean_rank;   ///< of each method, by its final losses
  /// Share of problems where it is finite and none reaches a harder target.
  std::vector<double> lowest;
  std::vector<MethodPair> pairs;  ///< of all methods, in this order
};

/// Of losses at the end of the chains, by the hardest of the targets of the
/// runtime distribution (performance_profiles.h) that they reach: losses that
/// reach the same ones, that are below kEqualLoss, or that are not finite, are
/// equal. That of a chain that failed is not finite.
Standings standings(const CommonRuns& common);

/// The first against the next: "JPO ranks best of 5 methods: on 336 problems
/// its final loss compared with BFGS, the next, is lower on 32 % ...", or that
/// no method is clearly ahead, or the names of those that end equal on every
/// problem. Empty if no two methods can be compared.
std::string standing_text(const CommonRuns& common,
                          const Standings& standings,
                          const std::map<std::string, std::string>& titles);

/// The sentence and the tables `standings`, `running_time` and `rank_test`;
/// nothing if no two methods can be compared.
void add_standings(Section& section,
                   const CommonRuns& common,
                   const std::map<std::string, std::string>& titles);

}  // namespace physinv
