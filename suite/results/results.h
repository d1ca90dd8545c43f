/// A finished (or running) campaign as everybody reads it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "suite/store/record.h"

namespace physinv {

class Results {
 public:
  Results() = default;
  explicit Results(std::vector<CaseRecord> cases);

  const std::vector<CaseRecord>& cases() const { return cases_; }

  /// The finished stage `stage` of the case of this experiment, method, n and
  /// seed; null if it is not there ("not run").
  const StageRecord* find(std::string_view experiment,
                          std::string_view method,
                          Index n,
                          std::uint64_t seed,
                          std::string_view stage) const;
  const CaseRecord* find_case(std::string_view experiment,
                              std::string_view method,
                              Index n,
                              std::uint64_t seed) const;

  /// Sorted values present for an experiment.
  std::vector<Index> sizes(std::string_view experiment) const;
  std::vector<std::uint64_t> seeds(std::string_view experiment) const;
  std::vector<std::string> methods(std::string_view experiment) const;

 private:
  std::vector<CaseRecord> cases_;
};

/// Of all stages with a result, by experiment.
std::map<std::string, Counts> work_of(const Results& results);

/// Everything a directory holds, in the order of its campaign. StoreError if
/// something is damaged, UnreadableInput if there is nothing or it is of a
/// newer schema.
Results load_results(const std::filesystem::path& directory);

}  // namespace physinv
