#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "reports/digest.h"
#include "suite/app/options.h"
#include "suite/results/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

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
    auto digest = nlohmann::ordered_json::parse(
        read_file(path / "digest.json"), nullptr, false);
    if (digest.is_discarded())
      throw UnreadableInput((path / "digest.json").string() +
                            " is no JSON (write it again with report "
                            "--publish)");
    found.push_back({path.filename().string(), std::move(digest)});
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
  try {
    write_atomically(out, results_markdown(found));
  } catch (const StoreError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw UnreadableInput(campaigns + ": " + error.what());
  }
  fmt::print("{} campaigns: {}\n", found.size(), out);
  return ExitCode::good;
}

}  // namespace physinv
