/// A campaign as `report --publish` keeps it with the sources: results.json.gz
/// and digest.json.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reports/digest.h"
#include "reports/report.h"
#include "suite/app/load.h"
#include "suite/results/published.h"
#include "suite/results/results.h"

namespace physinv {

/// Does the directory hold such a campaign, and no journal?
bool is_published(const std::filesystem::path& directory);

/// Its digest, with each claim judged by what is registered now; StoreError
/// with the file's name if it is damaged.
NamedDigest published_digest(const std::filesystem::path& directory,
                             const Published& published);
/// Those of the folders of `directory` that hold one, by name; or of these
/// names alone. UsageError if there is no such directory, ExitError if none
/// holds one, or one of the names is not there.
std::vector<NamedDigest> published_digests(
    const std::filesystem::path& directory,
    const std::vector<std::string>& names = {});

/// Keeps a campaign in a folder, so that a later one, and the page of results,
/// can be made from it; without the directory that it lay in.
void publish_campaign(const std::filesystem::path& folder,
                      const Loaded& loaded,
                      const std::vector<Section>& sections,
                      nlohmann::ordered_json provenance);

/// Its figures, by experiment.
std::map<std::string, std::vector<Picture>> kept_pictures(
    const std::filesystem::path& directory,
    const nlohmann::ordered_json& digest);

/// What results.json says of its stages: ends, counts, times, and the median
/// loss in place of all losses. Without curves, estimates or problems.
Results published_results(const std::filesystem::path& directory);
/// The same of its text.
Results summarized_results(const nlohmann::ordered_json& results);

}  // namespace physinv
