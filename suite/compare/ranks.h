/// Are losses on one side lower than on the first? Paired over the same
/// problems.
#pragma once

#include <string>
#include <vector>

#include "suite/compare/comparison.h"
#include "suite/evidence/rank_test.h"

namespace physinv {

/// A stage of a method on another side against the first, over all examples of
/// all n and seeds that both have.
struct SideRank {
  std::string experiment, method, stage;
  std::size_t side = 1;
  SignedRank test;  ///< below: the other side is lower
  double p = 1;     ///< by Holm over all of them

  bool differs() const { return p < kSignificant; }
  bool better() const { return test.down; }
};

/// Those that differ most surely first. A run that failed, on either side, has
/// no loss, which counts as the highest; stages with other numbers of losses,
/// or that failed on both sides, have no pairs.
std::vector<SideRank> side_ranks(const std::vector<Side>& sides);

/// Of these the first `most`.
Table rank_table(const std::vector<SideRank>& ranks,
                 const std::vector<std::string>& labels,
                 std::size_t most);

}  // namespace physinv
