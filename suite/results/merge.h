/// Joins the stores of a sharded campaign.
#pragma once

#include <filesystem>
#include <vector>

namespace physinv {

/// Writes to `out` what the unsharded campaign would have left there, apart
/// from times. A stage that stands in several shards must be the same in all.
/// UnreadableInput, naming both directories, if shards disagree about a stage,
/// the campaign's cases, the profile or the fingerprint of the numerics.
/// What `out` already holds takes part like a shard, so an interrupted merge
/// can be repeated.
void merge(const std::vector<std::filesystem::path>& shards,
           const std::filesystem::path& out);

}  // namespace physinv
