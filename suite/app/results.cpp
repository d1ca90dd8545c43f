#include "suite/results/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "reports/digest.h"
#include "reports/report.h"
#include "suite/app/installed.h"
#include "suite/app/options.h"
#include "suite/evidence/claim.h"
#include "suite/results/file.h"
#include "suite/results/json.h"
#include "suite/results/published.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// What is registered under this id of an experiment, or of a paper's
/// overview; null if there is nothing.
const Claim* claim_of(const std::string& name, const std::string& id) {
  const auto find = [&](const std::vector<Claim>& claims) -> const Claim* {
    for (const Claim& c : claims)
      if (c.id == id) return &c;
    return nullptr;
  };
  if (const auto e = registry().find(name)) return find(e->claims);
  for (const Overview& o : registry().overviews())
    if (o.paper == name) return find(o.claims);
  return nullptr;
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

/// A digest keeps the numbers of its conditions: each claim is judged by what
/// is registered now, and has the cause that it states now.
void renew(nlohmann::ordered_json& digest, const Published& published) {
  const Results plan = planned(digest.at("provenance").value("profile", ""));
  for (auto& section : digest.at("sections")) {
    const std::string experiment = section.at("experiment");
    for (auto& claim : section.at("claims"))
      if (const Claim* now = claim_of(experiment, claim.at("id")))
        claim = to_json(judge_again(
            *now, claim_from(claim), {plan, published, experiment}));
  }
}

/// That can be shown; StoreError with the file's name if it cannot.
nlohmann::ordered_json digest_in(const fs::path& folder,
                                 const Published& published) {
  const fs::path path = folder / "digest.json";
  const std::string bytes = read_file(path);
  try {
    auto digest = parse_json<nlohmann::ordered_json>(bytes);
    if (!is_intact(digest)) throw std::runtime_error("it fails its checksum");
    renew(digest, published);
    results_markdown({{folder.filename().string(), digest}});
    return digest;
  } catch (const std::exception& error) {
    throw StoreError(
        fmt::format("{} is damaged: {} (write it again with report --publish)",
                    path.string(),
                    error.what()));
  }
}

/// The folders of `directory` that hold a digest, by name.
std::vector<NamedDigest> digests(const fs::path& directory) {
  if (!fs::is_directory(directory))
    throw UsageError(fmt::format("there is no directory '{}' of campaigns",
                                 directory.string()));
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(directory))
    if (fs::exists(entry.path() / "digest.json")) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  const Published published(published_directory());
  std::vector<NamedDigest> found;
  for (const auto& path : paths)
    found.push_back({path.filename().string(), digest_in(path, published)});
  if (found.empty())
    throw ExitError(ExitCode::nothing_matched,
                    fmt::format("no folder of '{}' holds a digest.json; "
                                "report --publish writes one",
                                directory.string()));
  return found;
}

}  // namespace

ExitCode results_verb(const Arguments& arguments) {
  std::string campaigns = "reports/campaigns", out = "RESULTS.md";
  if (!parse("results",
             "Writes a page of all published campaigns: what is not reproduced "
             "and why, then claims and tables, each with machine, build, date "
             "and command. Claims are judged anew by the numbers that were "
             "kept.",
             {{"--campaigns",
               "folder of what report --publish wrote, shown in the order of "
               "their names (default "
               "reports/campaigns)",
               &campaigns,
               "DIR"},
              {"--out", "the page (default RESULTS.md)", &out, "FILE"}},
             arguments))
    return ExitCode::good;
  const auto found = digests(campaigns);
  write_atomically(out, results_markdown(found));
  fmt::print("{} campaigns: {}\n", found.size(), out);
  return ExitCode::good;
}

}  // namespace physinv
