/// What a store lacks of what it was asked for.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace physinv {

class Catalog;
struct CaseRecord;

struct MissingWork {
  std::size_t stages = 0;                 ///< of all cases that have one
  std::vector<std::string> unrun_cases;   ///< planned, without a stage
  std::vector<std::string> unrun_stages;  ///< "case stage", so below
  std::vector<std::string> failed;        ///< failed or skipped
  std::vector<std::string> lost;  ///< in the journal, arrays lost or replaced
  bool unknown_plan = false;

  bool any() const;
  /// Counts one case in.
  void add(const Catalog& catalog, const CaseRecord& c);
};

/// `cases` as the catalog gave them, arrays or summaries.
MissingWork missing_work(const Catalog& catalog,
                         const std::vector<CaseRecord>& cases);

/// "6 cases not run (first a/b/n=4/seed=0), ..."; empty if nothing lacks.
std::string to_text(const MissingWork& lacks);

}  // namespace physinv
