/// A stored campaign as the verbs read it.
#pragma once

#include <cstdio>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "suite/results/results.h"
#include "suite/store/catalog.h"
#include "suite/store/missing_work.h"

namespace physinv {

struct Loaded {
  Catalog catalog;
  Results results;
  MissingWork lacks;
};

/// Prints what the catalog warns of; to another stream than standard output
/// only where nothing lacks. UsageError if there is no directory, StoreError if
/// something is damaged: results.json is compared with what it is made from.
Loaded load(const std::string& directory, std::FILE* warnings = stdout);

/// What results.json says, made again.
nlohmann::ordered_json results_of(const Loaded& loaded);

inline constexpr std::string_view kRunAgain =
    "repeat the same 'run', which reuses finished stages; for a merge, merge "
    "all shards again";

/// ExitError (incomplete) with `advice` if anything lacks.
void require_complete(const MissingWork& lacks, std::string_view advice);

}  // namespace physinv
