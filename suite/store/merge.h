/// Joins the stores of a sharded campaign.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "suite/store/lock.h"
#include "suite/store/missing_work.h"

namespace physinv {

struct Merged {
  MissingWork lacks;                  ///< what the whole campaign still lacks
  std::vector<std::string> warnings;  ///< about shards, and OUT's lock
};

/// Writes to `out` what the unsharded campaign would have left there, apart
/// from times. A stage that several shards have must be the same in all.
/// UnreadableInput, naming both directories, if shards disagree about a stage,
/// the campaign's cases and what they run, the profile or the fingerprint of
/// the numerics; also if `out` is a shard or holds a campaign of its own. What
/// an earlier merge left in `out` takes part like a shard, so that merges can
/// be repeated and continued.
Merged merge(const std::vector<std::filesystem::path>& shards,
             const std::filesystem::path& out,
             const LockOptions& lock = {});

}  // namespace physinv
