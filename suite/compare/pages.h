/// A comparison as tables, figures and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "suite/compare/comparison.h"
#include "suite/compare/ranks.h"

namespace physinv {

/// What changed: per line losses, their ratio, ratios of time and work, how
/// stages ended. Of many lines the first `most`.
Table changes_table(const Comparison& comparison, std::size_t most);
/// The same without the rows that are unchanged, which its note counts.
Table folded_table(const Comparison& comparison, std::size_t most);
/// "20 of 24 rows unchanged"
std::string unchanged_text(const Comparison& comparison);

/// Per experiment how many stages each side lacks that another has.
Table missing_table(const Comparison& comparison);

/// Per side: what the examples ended as; times; counters.
std::vector<Table> detail_tables(const Comparison& comparison);

/// Verdicts per side; no rows if none changed.
Table claims_table(const std::vector<ChangedClaim>& changed,
                   const std::vector<std::string>& labels);

/// For the HTML report: an overview, then an experiment each with its tables,
/// losses over time of all sides, and performance profiles, running times and
/// ranks over all of them.
std::vector<Section> compare_sections(const Comparison& comparison,
                                      const std::vector<Side>& sides,
                                      const std::vector<ChangedClaim>& changed,
                                      const std::vector<SideRank>& ranks);

nlohmann::ordered_json to_json(const Comparison& comparison,
                               const std::vector<ChangedClaim>& changed,
                               const std::vector<SideRank>& ranks);

}  // namespace physinv
