/// A comparison in a sentence for each side, and in a row for each method.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "suite/compare/comparison.h"
#include "suite/compare/ranks.h"

namespace physinv {

/// A method on a side against the first, over the stages, n and seeds that all
/// sides have.
struct MethodChange {
  std::string experiment, method;
  std::size_t side = 1;
  /// Of the last stage: examples solved on the first side and on this one.
  Index solved_first = 0, solved = 0, examples_first = 0, examples = 0;
  /// The test of the losses of the last stage; null if there is none.
  const SideRank* rank = nullptr;
  /// Seconds of all stages of a run against those on the first side, both
  /// raised to kShortTime, median over the runs; absent if none compares.
  std::optional<double> time;
  std::size_t stages = 0, better_ends = 0, worse_ends = 0;
  bool unchanged = true;  ///< all of its stages, and no loss differs surely
};
std::vector<MethodChange> method_changes(const Comparison& comparison,
                                         const std::vector<SideRank>& ranks);

/// Methods that changed: shares solved, losses, times and ends on each side.
/// At most `most` rows; the note says how many methods did not change.
Table method_table(const std::vector<MethodChange>& changes,
                   const Comparison& comparison,
                   std::size_t most);

/// Which methods changed and how: "b against a: higher losses: supervised (on
/// 57 % of 336 problems, p = 0.001); slower: jpo (×2.2); 3 of 5 methods
/// unchanged", one for each side after the first.
std::vector<std::string> summary_sentences(
    const std::vector<MethodChange>& changes, const Comparison& comparison);

}  // namespace physinv
