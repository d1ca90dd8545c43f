/// What several verbs read from their flags.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "suite/app/flags.h"
#include "suite/harness/case.h"

namespace physinv {

struct Overrides;
struct PlannedCase;
struct Shard;

/// Flags that choose cases.
struct Selection {
  std::vector<std::string> filters, sets;
  std::vector<std::string> words;  ///< filters without --filter
  std::string profile = "quick", seeds, shard, list;
  bool all = false;    ///< words are searched in all experiments at once
  bool plain = false;  ///< no words: filters are regular expressions

  /// Its flags, followed by a verb's own.
  std::vector<Flag> flags(const std::vector<Flag>& own = {});
  /// The filters that follow a verb without a flag.
  Flag arguments();
  /// The chosen cases in declared order, of this shard; `campaign` gets those
  /// of all shards. From then on `filters` are regular expressions, of `words`
  /// too. Throws UsageError, or ExitError with the nearest names if nothing
  /// matched, or one of `words` matches nothing.
  std::vector<Case> cases(std::vector<PlannedCase>* campaign = nullptr);

 private:
  void read_words(const std::vector<Case>& all_cases);
  [[noreturn]] void refuse(const std::vector<Case>& all_cases,
                           const std::string& asked) const;
};

/// "n=8,32" and the like into overrides; throws UsageError.
Overrides parse_overrides(const std::vector<std::string>& sets,
                          const std::string& seeds);

/// "90", "90s", "10m", "2h" in seconds; throws UsageError.
double parse_duration(const std::string& flag, const std::string& text);

/// "2/3"; throws UsageError.
Shard parse_shard(const std::string& text);

/// The directory of a finished campaign, or UsageError.
std::filesystem::path results_directory(const std::string& text);

}  // namespace physinv
