/// The numbers of a section that are shown next to the paper's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

struct Statement {
  std::string what, here;
  std::string paper;  ///< of a claim its condition, of a cell what was printed
  Verdict verdict = Verdict::not_judged;
  Origin origin = Origin::paper;
};

/// The condition that says most: the first that does not hold, else the first
/// of those with bounds that was measured; null if there is none.
const ConditionResult* telling(const ClaimResult& claim);

/// Counts as they are, other numbers with three digits.
std::string value_text(double value);

/// At most so many, in this order: the paper's statements that are decided,
/// those that do not hold first; the suite's ranges that fail; cells of tables
/// for which the paper printed a number, of each table in turn. Tables of times
/// are left out: the paper's machine was another one.
std::vector<Statement> statements_of(const Section& section,
                                     std::size_t most = SIZE_MAX);

}  // namespace physinv
