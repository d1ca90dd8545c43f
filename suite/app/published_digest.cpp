#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "reports/digest_tables.h"
#include "reports/results_page.h"
#include "suite/app/installed.h"
#include "suite/app/published_campaign.h"
#include "suite/evidence/claim.h"
#include "suite/harness/errors.h"
#include "suite/harness/judge.h"
#include "suite/harness/registry.h"
#include "suite/store/file.h"
#include "suite/store/json.h"
#include "suite/store/results_file.h"
#include "suite/store/results_json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Of solving, by experiment.
std::map<std::string, double> cpu_seconds(const Json& results) {
  std::map<std::string, double> seconds;
  for (const Json& entry : results.at("benchmarks")) {
    if (!entry.contains("cpu_time") || !entry.contains("physinv")) continue;
    const std::string experiment = entry["physinv"].value("experiment", "");
    seconds[experiment] +=
        seconds_per_unit(entry) * entry["cpu_time"].get<double>();
  }
  return seconds;
}

/// results.json.gz in the folder of a digest: they name each other, unless both
/// are older than that.
Json results_beside(const fs::path& folder, const Json& digest) {
  const fs::path path = folder / "results.json.gz";
  Json results = parse_results(gunzipped(read_file(path), kLargestData), path);
  Json& own = results.at("context")["physinv"];
  const std::string told = own.value("digest", "");
  own.erase("digest");
  const bool linked = !told.empty() || digest.contains("results");
  if (linked && (told != digest.value("checksum", "") ||
                 digest.value("results", "") != checksum_of(results)))
    throw std::runtime_error(
        "the results.json.gz next to it belongs to another digest");
  return results;
}

/// Pages link to them.
void require_figures(const fs::path& folder, const Json& digest) {
  for (const Json& section : digest.at("sections"))
    for (const Json& figure : section.value("figures", Json::array())) {
      const std::string name = figure.at("file");
      if (!is_file(folder / "figures" / name))
        throw std::runtime_error("its figure " + name + " is missing");
    }
}

/// The cases of a profile as if they had been run, without a number: sizes and
/// seeds alone.
Results planned(const std::string& profile) {
  const auto known = registry().profiles();
  if (std::find(known.begin(), known.end(), profile) == known.end()) return {};
  std::vector<CaseRecord> cases;
  for (const Case& c : registry().expand(profile)) {
    CaseRecord record{.info = c.info, .data = {}, .stages = {}};
    for (const std::string& name : c.info.stages) {
      StageRecord stage;
      stage.stage = name;
      record.stages.push_back(std::move(stage));
    }
    cases.push_back(std::move(record));
  }
  return Results(std::move(cases));
}

/// Tables of a paper's own section that its campaign did not have yet, by what
/// results.json keeps.
void add_tables(const std::string& paper,
                const Results& stages,
                const Published& published,
                Json& tables) {
  if (!tables.empty()) return;
  for (const Overview& o : registry().overviews())
    if (o.paper == paper && o.report)
      for (const Table& table : o.report({stages, published, paper}).tables)
        tables.push_back(table_json(table));
}

/// A digest keeps the numbers of its conditions: each claim is judged by what
/// is registered now, and has the cause that it states now. One that the
/// campaign did not have yet waits for a run. `stages` are what results.json
/// keeps.
void renew(Json& digest, const Results& stages, const Published& published) {
  const Results plan = planned(digest.at("provenance").value("profile", ""));
  for (auto& section : digest.at("sections")) {
    const std::string experiment = section.at("experiment");
    add_tables(experiment, stages, published, section.at("tables"));
    Json& kept = section.at("claims");
    for (const Claim& now : claims_of(registry(), experiment)) {
      const auto own = std::find_if(kept.begin(), kept.end(), [&](Json& claim) {
        return claim.at("id") == now.id;
      });
      ClaimResult before{.evidence = kNotKept};
      if (own != kept.end()) before = claim_from(*own);
      const Evidence planned{plan, published, experiment},
          left{stages, published, experiment};
      const ClaimResult again = judge_again(now, before, {planned, left});
      Json judged = to_json(again);
      judged["cases"] = cases_behind(now, again, left);
      if (own != kept.end())
        *own = std::move(judged);
      else
        kept.push_back(std::move(judged));
    }
  }
}

}  // namespace

NamedDigest published_digest(const fs::path& folder,
                             const Published& published) {
  const fs::path path = folder / "digest.json";
  const std::string bytes = read_file(path);
  try {
    auto digest = parse_json<Json>(bytes);
    if (!is_intact(digest)) throw std::runtime_error("its checksum is wrong");
    const Json results = results_beside(folder, digest);
    require_figures(folder, digest);
    const Results stages = summarized_results(results);
    NamedDigest named{folder.filename().string(),
                      digest,
                      cpu_seconds(results),
                      work_of(stages)};
    renew(named.digest, stages, published);
    results_markdown({named});
    experiment_pages({named});
    return named;
  } catch (const std::exception& error) {
    throw StoreError(
        fmt::format("{} is damaged: {} (write it again with report --publish)",
                    path.string(),
                    error.what()));
  }
}

std::vector<NamedDigest> published_digests(
    const fs::path& directory, const std::vector<std::string>& names) {
  if (!is_folder(directory))
    throw UsageError(
        fmt::format("there is no directory '{}' of published campaigns",
                    directory.string()));
  std::set<std::string> missing(names.begin(), names.end());
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(directory))
    if (is_there(entry.path() / "digest.json") &&
        (names.empty() || missing.erase(entry.path().filename()) > 0))
      paths.push_back(entry.path());
  if (!missing.empty())
    throw ExitError(
        ExitCode::nothing_matched,
        fmt::format("there is no campaign '{}' in {}; RESULTS.md lists them",
                    *missing.begin(),
                    directory.string()));
  std::sort(paths.begin(), paths.end());
  const Published published(published_directory());
  std::vector<NamedDigest> found;
  for (const auto& path : paths)
    found.push_back(published_digest(path, published));
  if (found.empty())
    throw ExitError(ExitCode::nothing_matched,
                    fmt::format("no folder in '{}' contains a digest.json; "
                                "report --publish writes one",
                                directory.string()));
  return found;
}

}  // namespace physinv
