#include "suite/results/results.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <utility>

#include "reports/digest.h"
#include "reports/html.h"
#include "reports/latest_claims.h"
#include "reports/report.h"
#include "reports/results_page.h"
#include "suite/app/history.h"
#include "suite/app/installed.h"
#include "suite/app/options.h"
#include "suite/app/published_campaign.h"
#include "suite/app/sections.h"
#include "suite/results/published.h"
#include "suite/store/file.h"
#include "suite/store/folder.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Pages of each campaign in a folder of its name, what leads to them, the
/// newest first, and the history of the gate where git has one.
void write_html(const fs::path& directory,
                const fs::path& campaigns,
                const std::vector<NamedDigest>& found,
                const Published& published) {
  std::vector<CampaignPages> all;
  for (const NamedDigest& c : newest_first(found)) {
    CampaignPages pages{.name = c.name,
                        .command = campaign_command(c.name),
                        .provenance = c.digest.at("provenance"),
                        .sections = sections_of(c)};
    nlohmann::ordered_json origin = pages.provenance;
    origin["command"] = pages.command;
    write_report(directory / c.name,
                 pages.sections,
                 origin,
                 {.one_file = false,
                  .groups = groups_of(published),
                  .pictures = kept_pictures(campaigns / c.name, c.digest)});
    all.push_back(std::move(pages));
  }
  std::vector<std::pair<std::string, std::string>> others;
  const GitHistory history = history_of_git(kGateBaseline);
  if (!history.sections.empty()) {
    write_report(
        directory / "history", history.sections, history_origin(kGateBaseline));
    others.emplace_back("history", "What the gate measured, commit by commit");
  }
  if (!history.lacks.empty())
    fmt::print("note: the history of the gate is incomplete: {}\n",
               history.lacks);
  Folder(directory).write("index.html", campaigns_html(all, others));
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
          fmt::format("{} is not a page written by 'results'; choose another "
                      "folder with --pages, or move it",
                      (directory / name).string()));
  for (const auto& [name, text] : pages)
    if (!folder.has(name) || folder.read(name, kLargestText) != text)
      folder.write(name, text);
}

}  // namespace

ExitCode results_verb(const Arguments& arguments) {
  std::string campaigns = "reports/campaigns", out = "RESULTS.md", pages, html;
  if (!parse(
          "results",
          "Writes an overview of all published campaigns: the answer to "
          "each paper's main question, and the statements that are not "
          "reproduced with their causes. Writes a page for each experiment "
          "with its statements, tables, figures, machine, build, date and "
          "command, and a page of regression checks. Claims are judged by "
          "the numbers that the campaigns stored.",
          {{"--campaigns",
            "folder of published campaigns (report --publish); the newest "
            "campaign that decided a claim counts (default reports/campaigns)",
            &campaigns,
            "DIR"},
           {"--out", "the overview (default RESULTS.md)", &out, "FILE"},
           {"--pages",
            "directory for the pages of experiments (default docs/results next "
            "to the overview)",
            &pages,
            "DIR"},
           {"--html",
            "write HTML pages of each campaign, an index and the history of "
            "the gate to this directory instead",
            &html,
            "DIR"}},
          arguments))
    return ExitCode::good;
  const auto found = published_digests(campaigns);
  const Published published(published_directory());
  if (!html.empty()) {
    write_html(html, campaigns, found, published);
    fmt::print("{} campaigns: {}\n",
               found.size(),
               (fs::path(html) / "index.html").string());
    return ExitCode::good;
  }
  const fs::path beside = fs::absolute(out).parent_path();
  const fs::path below = pages.empty()
                             ? fs::path(out).parent_path() / "docs/results"
                             : fs::path(pages);
  const ResultsLinks links{.pages = link(beside, below),
                           .overview = link(below, out),
                           .campaigns = link(below, campaigns)};
  try {
    auto written = experiment_pages(found, links);
    written[kChecksPage] = checks_markdown(found, links);
    write_pages(below, written);
  } catch (const std::runtime_error& error) {
    throw EnvironmentError(error.what());
  }
  write_atomically(out,
                   results_markdown(found, published.publications(), links));
  fmt::print("{} campaigns: {}\n", found.size(), out);
  return ExitCode::good;
}

}  // namespace physinv
