#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "reports/digest.h"
#include "suite/app/options.h"
#include "suite/results/file.h"
#include "suite/results/json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// That can be shown; StoreError with the file's name if it cannot.
nlohmann::ordered_json digest_in(const fs::path& folder) {
  const fs::path path = folder / "digest.json";
  const std::string bytes = read_file(path);
  try {
    auto digest = parse_json<nlohmann::ordered_json>(bytes);
    if (!is_intact(digest)) throw std::runtime_error("it fails its checksum");
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
