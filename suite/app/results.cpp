#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "reports/digest.h"
#include "suite/app/options.h"
#include "suite/results/file.h"
#include "suite/results/json.h"
#include "suite/results/results_file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A digest and results.json.gz beside it tell of each other, unless both are
/// of before they did.
void require_one_campaign(const fs::path& folder, const Json& digest) {
  const fs::path path = folder / "results.json.gz";
  Json results = parse_results(gunzipped(read_file(path), kLargestData), path);
  Json& own = results.at("context")["physinv"];
  const std::string told = own.value("digest", "");
  own.erase("digest");
  if (told != digest.value("checksum", "") ||
      (!told.empty() && digest.value("results", "") != checksum_of(results)))
    throw std::runtime_error("results.json.gz beside it is of another");
}

/// That can be shown; StoreError with the file's name if it cannot.
Json digest_in(const fs::path& folder) {
  const fs::path path = folder / "digest.json";
  const std::string bytes = read_file(path);
  try {
    auto digest = parse_json<Json>(bytes);
    if (!is_intact(digest)) throw std::runtime_error("it fails its checksum");
    results_markdown({{folder.filename().string(), digest}});
    require_one_campaign(folder, digest);
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
  std::vector<NamedDigest> found;
  for (const auto& path : paths) {
    found.push_back({path.filename().string(), digest_in(path)});
  }
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
             "Writes a page of all published campaigns: claims and tables, "
             "each with machine, build, date and command.",
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
