/// plan.json: what a store was asked for.
///
///   cases     names of the whole campaign in order, shards included
///   recipes   of each case: what it runs, apart from data and numerics
///   keys      content keys of the cases asked for here
///   stages    names of their stages
///   profile, fingerprint, context   as for results.json
///   results   checksum of the results.json that the plan found, which has an
///             earlier context until it is written again
///   checksum  CRC-32C of the rest, compact and sorted
///
/// Version 1 had no checksum, recipes and keys; it is read with a warning.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "suite/store/record.h"

namespace physinv {

struct PlannedCase {
  std::string name;
  std::string recipe;  ///< hash, or empty if it is not compared
};

/// A campaign, of which this store runs `cases`; all of it if `campaign` is
/// empty.
nlohmann::json make_plan(const std::vector<CaseInfo>& cases,
                         const nlohmann::json& context,
                         std::vector<PlannedCase> campaign);

/// `plan` after `earlier`: what was asked for earlier still is, unless it was
/// another profile or build. A part of the earlier campaign keeps its order.
nlohmann::json extend_plan(const nlohmann::json& earlier, nlohmann::json plan);

/// With its checksum.
std::string plan_text(nlohmann::json plan);

/// Null if there is none; `warning` gets a word about that or an old version.
/// StoreError if it is damaged, UnreadableInput if it is of a newer version.
nlohmann::json read_plan(const std::filesystem::path& path,
                         std::string* warning);
/// The same of a file's bytes; `path` is for messages.
nlohmann::json parse_plan(std::string_view bytes,
                          const std::filesystem::path& path,
                          std::string* warning);

/// The content keys that the plan names for a case, or `otherwise`.
std::vector<std::string> planned_keys(const nlohmann::json& plan,
                                      const std::string& case_name,
                                      std::vector<std::string> otherwise);

/// Names of a case's stages; none if the plan does not tell them.
std::vector<std::string> planned_stages(const nlohmann::json& plan,
                                        const std::string& case_name);

}  // namespace physinv
