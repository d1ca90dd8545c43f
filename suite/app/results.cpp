#include "suite/results/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "reports/report.h"
#include "reports/results_page.h"
#include "suite/app/installed.h"
#include "suite/app/options.h"
#include "suite/evidence/claim.h"
#include "suite/results/file.h"
#include "suite/results/folder.h"
#include "suite/results/json.h"
#include "suite/results/published.h"
#include "suite/results/results_file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Of solving, by experiment: entries of version 1 tell milliseconds.
std::map<std::string, double> cpu_seconds(const Json& results) {
  std::map<std::string, double> seconds;
  for (const Json& entry : results.at("benchmarks")) {
    if (!entry.contains("cpu_time") || !entry.contains("physinv")) continue;
    const double unit = entry.value("time_unit", "ns") == "ms" ? 1e-3 : 1e-9;
    const std::string experiment = entry["physinv"].value("experiment", "");
    seconds[experiment] += unit * entry["cpu_time"].get<double>();
  }
  return seconds;
}

/// results.json.gz beside a digest: they tell of each other, unless both are
/// of before they did.
Json results_beside(const fs::path& folder, const Json& digest) {
  const fs::path path = folder / "results.json.gz";
  Json results = parse_results(gunzipped(read_file(path), kLargestData), path);
  Json& own = results.at("context")["physinv"];
  const std::string told = own.value("digest", "");
  own.erase("digest");
  const bool linked = !told.empty() || digest.contains("results");
  if (linked && (told != digest.value("checksum", "") ||
                 digest.value("results", "") != checksum_of(results)))
    throw std::runtime_error("results.json.gz beside it is of another");
  return results;
}

/// Pages link to them.
void require_figures(const fs::path& folder, const Json& digest) {
  for (const Json& section : digest.at("sections"))
    for (const Json& figure : section.value("figures", Json::array())) {
      const std::string name = figure.at("file");
      if (!fs::is_regular_file(folder / "figures" / name))
        throw std::runtime_error("its figure " + name + " is missing");
    }
}

/// The claims of an experiment, or of a paper's overview; none of what is not
/// registered.
std::vector<Claim> claims_of(const std::string& name) {
  if (const auto e = registry().find(name)) return e->claims;
  for (const Overview& o : registry().overviews())
    if (o.paper == name) return o.claims;
  return {};
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
/// is registered now, and has the cause that it states now. One that the
/// campaign did not know yet waits for a run.
void renew(Json& digest, const Published& published) {
  const Results plan = planned(digest.at("provenance").value("profile", ""));
  for (auto& section : digest.at("sections")) {
    const std::string experiment = section.at("experiment");
    Json& kept = section.at("claims");
    for (const Claim& now : claims_of(experiment)) {
      const auto own = std::find_if(kept.begin(), kept.end(), [&](Json& claim) {
        return claim.at("id") == now.id;
      });
      ClaimResult before{.evidence = kNotKept};
      if (own != kept.end()) before = claim_from(*own);
      Json judged =
          to_json(judge_again(now, before, {plan, published, experiment}));
      if (own != kept.end())
        *own = std::move(judged);
      else
        kept.push_back(std::move(judged));
    }
  }
}

/// That can be shown; StoreError with the file's name if it cannot.
NamedDigest digest_in(const fs::path& folder, const Published& published) {
  const fs::path path = folder / "digest.json";
  const std::string bytes = read_file(path);
  try {
    auto digest = parse_json<Json>(bytes);
    if (!is_intact(digest)) throw std::runtime_error("it fails its checksum");
    const Json results = results_beside(folder, digest);
    require_figures(folder, digest);
    NamedDigest named{
        folder.filename().string(), digest, cpu_seconds(results), digest};
    renew(named.digest, published);
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
  for (const auto& path : paths) found.push_back(digest_in(path, published));
  if (found.empty())
    throw ExitError(ExitCode::nothing_matched,
                    fmt::format("no folder of '{}' holds a digest.json; "
                                "report --publish writes one",
                                directory.string()));
  return found;
}

/// From the folder of one to the other, with slashes.
std::string link(const fs::path& from, const fs::path& to) {
  return fs::absolute(to)
      .lexically_normal()
      .lexically_relative(fs::absolute(from).lexically_normal())
      .generic_string();
}

/// Pages replace those that this verb wrote, and nothing else.
void write_pages(const fs::path& directory,
                 const std::map<std::string, std::string>& pages) {
  make_directory(directory);
  const Folder folder(directory);
  for (const auto& [name, text] : pages)
    if (folder.has(name) &&
        folder.read(name, kLargestText).find(kWrittenByResults) ==
            std::string::npos)
      throw EnvironmentError(
          fmt::format("{} is no page of results; name another folder with "
                      "--pages, or move it",
                      (directory / name).string()));
  for (const auto& [name, text] : pages)
    if (!folder.has(name) || folder.read(name, kLargestText) != text)
      folder.write(name, text);
}

}  // namespace

ExitCode results_verb(const Arguments& arguments) {
  std::string campaigns = "reports/campaigns", out = "RESULTS.md", pages;
  if (!parse("results",
             "Writes a page of all published campaigns that has every "
             "statement once, what is not reproduced first and why, and a page "
             "for each experiment with tables, figures, machine, build, date "
             "and command. Claims are judged anew by the numbers that were "
             "kept.",
             {{"--campaigns",
               "folder of what report --publish wrote; the newest that decided "
               "a claim counts (default reports/campaigns)",
               &campaigns,
               "DIR"},
              {"--out", "the page (default RESULTS.md)", &out, "FILE"},
              {"--pages",
               "those of the experiments (default docs/results beside it)",
               &pages,
               "DIR"}},
             arguments))
    return ExitCode::good;
  const auto found = digests(campaigns);
  const fs::path beside = fs::absolute(out).parent_path();
  const fs::path below = pages.empty()
                             ? fs::path(out).parent_path() / "docs/results"
                             : fs::path(pages);
  const ResultsLinks links{.pages = link(beside, below),
                           .overview = link(below, out),
                           .campaigns = link(below, campaigns)};
  try {
    auto written = experiment_pages(found, links);
    if (auto audit = audit_markdown(found, links); !audit.empty())
      written[kAuditPage] = std::move(audit);
    write_pages(below, written);
  } catch (const std::runtime_error& error) {
    throw EnvironmentError(error.what());
  }
  write_atomically(out, results_markdown(found, links));
  fmt::print("{} campaigns: {}\n", found.size(), out);
  return ExitCode::good;
}

}  // namespace physinv
