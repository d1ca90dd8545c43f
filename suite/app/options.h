/// Flags that several verbs share.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "suite/app/verbs.h"
#include "suite/harness/registry.h"
#include "suite/harness/select.h"

namespace physinv {

/// Parses; prints the help and returns false if that was asked for. Throws
/// UsageError, with the nearest flag for an unknown one.
bool parse(CLI::App& app, const Arguments& arguments);

/// Flags that choose cases.
struct Selection {
  std::vector<std::string> filters, sets;
  std::string profile = "quick", seeds, shard;

  void add_to(CLI::App& app);
  /// The chosen cases in declared order, of this shard; `campaign` gets the
  /// names of all shards' cases. Throws UsageError, or ExitError with
  /// the nearest names if nothing matched.
  std::vector<Case> cases(std::vector<std::string>* campaign = nullptr) const;
};

/// "n=8,32" and the like into overrides; throws UsageError.
Overrides parse_overrides(const std::vector<std::string>& sets,
                          const std::string& seeds);

/// "2/3"; throws UsageError.
Shard parse_shard(const std::string& text);

/// The directory of a finished campaign, or UsageError.
std::filesystem::path results_directory(const std::string& text);

}  // namespace physinv
