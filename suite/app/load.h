/// A stored campaign as the verbs read it.
#pragma once

#include <string>
#include <string_view>

#include "suite/results/catalog.h"
#include "suite/results/results.h"
#include "suite/results/shortfall.h"

namespace physinv {

struct Loaded {
  Catalog catalog;
  Results results;
  Shortfall lacks;
};

/// Prints what the catalog warns of. UsageError if there is no directory.
Loaded load(const std::string& directory);

inline constexpr std::string_view kRunAgain =
    "'run' as before makes up for it and keeps the rest; a merge, all shards";

/// ExitError (incomplete) with `advice` if anything lacks.
void require_complete(const Shortfall& lacks, std::string_view advice);

}  // namespace physinv
