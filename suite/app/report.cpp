#include "reports/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "reports/digest.h"
#include "suite/app/installed.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/app/published_campaign.h"
#include "suite/app/sections.h"
#include "suite/harness/claim_tally.h"
#include "suite/harness/screen.h"
#include "suite/store/file.h"
#include "suite/store/folder.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

struct ReportFlags {
  std::string results, out, expected, publish;
  bool check = false, one_file = false;
};

/// Experiments of the results that this program does not have, with commas.
std::string unknown_text(const Results& results) {
  std::set<std::string> unknown;
  for (const CaseRecord& c : results.cases())
    if (!registry().find(c.info.experiment)) unknown.insert(c.info.experiment);
  return fmt::format("{}", fmt::join(unknown, ", "));
}

/// Prints the verdicts of the gating claims; ExitError if one fails
/// unexpectedly.
void check_claims(const ClaimTally& j) {
  const auto failing =
      j.known_misses.size() + j.misses.size() + j.explained.size();
  fmt::print(
      "{} gating claims judged: {} reproduced, {} explained by their cause, {} "
      "not reproduced as expected, {} not reproduced\n",
      j.judged,
      j.judged - failing,
      j.explained.size(),
      j.known_misses.size(),
      j.misses.size());
  for (const auto& claim : j.explained) fmt::print("explained: {}\n", claim);
  for (const auto& claim : j.known_misses)
    fmt::print("not reproduced, as expected: {}\n", claim);
  for (const auto& claim : j.surprises)
    fmt::print("reproduced, although not expected: {}\n", claim);
  for (const auto& claim : j.stale)
    fmt::print("reproduced, although its cause says: {}\n", claim);
  if (!j.misses.empty())
    throw ExitError(ExitCode::claim,
                    fmt::format("{} gating claims are not reproduced, first {}",
                                j.misses.size(),
                                j.misses.front()));
}

/// Pages of a campaign that is kept with the sources, which stays as it is.
ExitCode report_published(const std::string& results, const std::string& out) {
  if (out.empty())
    throw UsageError(
        fmt::format("'{}' is a published campaign and is never changed; give "
                    "the directory of the pages with --out=DIR",
                    results));
  const Published numbers = printed_numbers();
  const auto campaign = published_digest(results, numbers);
  const auto sections = sections_of(campaign);
  auto origin = campaign.digest.at("provenance");
  origin["command"] =
      campaign_command(fs::path(results).lexically_normal().filename());
  write_report(out,
               sections,
               origin,
               {.one_file = false,
                .groups = groups_of(numbers),
                .pictures = kept_pictures(results, campaign.digest)});
  fmt::print(
      "{}report: {}\n{}: {}\n",
      render_claims_text(sections,
                         static_cast<std::size_t>(Screen::of(stdout).columns)),
      (fs::path(out) / "index.html").string(),
      is_folder(fs::path(results) / "figures")
          ? "figures of curves are the published ones; command"
          : "figures are not stored with this campaign; command",
      origin["command"].get<std::string>());
  return ExitCode::good;
}

/// Nothing that has a report: why.
[[noreturn]] void refuse_empty(const ReportFlags& flags,
                               const Loaded& loaded,
                               const std::string& unknown) {
  require_complete(loaded.lacks, kRunAgain);
  if (!unknown.empty())
    throw ExitError(ExitCode::nothing_matched,
                    fmt::format("this program does not have {}; report with "
                                "the program that ran it",
                                unknown));
  throw ExitError(ExitCode::nothing_matched,
                  "no experiment with a report has results in '" +
                      flags.results + "'; run cases first");
}

void print_summary(const std::vector<Section>& sections,
                   const fs::path& target,
                   const nlohmann::ordered_json& origin,
                   const std::string& unknown) {
  fmt::print(
      "{}report: {}\n",
      render_claims_text(sections,
                         static_cast<std::size_t>(Screen::of(stdout).columns)),
      (target / "index.html").string());
  if (origin.contains("crowded"))
    fmt::print("{}\n", origin["crowded"].get<std::string>());
  if (!unknown.empty())
    fmt::print("not reported: this program does not have {}\n", unknown);
}

/// False if help was asked for.
bool parse_flags(const Arguments& arguments, ReportFlags& flags) {
  return parse(
      "report",
      "Writes tables, plots and claims of a finished campaign. Exit 10 "
      "if the campaign is incomplete.",
      {{"RESULTS",
        "directory that 'run' or 'report --publish' wrote",
        &flags.results},
       {"--out",
        "output directory; default: RESULTS/report",
        &flags.out,
        "DIR"},
       {"--one-file",
        "write one page that contains everything",
        &flags.one_file},
       {"--publish",
        "also write results.json (compressed), a digest of claims and tables, "
        "and figures to this directory, for the verb 'results'",
        &flags.publish,
        "DIR"},
       {"--check",
        "exit 7 if a gating claim is not reproduced and states no cause, 10 if "
        "these runs decide none",
        &flags.check},
       {"--expected",
        "claims that need no cause for --check, such as 'jpo/arm R3, "
        "jpo/billiards P1'",
        &flags.expected,
        "CLAIMS"}},
      arguments);
}

}  // namespace

ExitCode report_verb(const Arguments& arguments) {
  ReportFlags flags;
  if (!parse_flags(arguments, flags)) return ExitCode::good;
  if (is_published(flags.results)) {
    if (flags.check || !flags.publish.empty() || flags.one_file)
      throw UsageError(fmt::format(
          "'{}' is a published campaign, for which report accepts only --out",
          flags.results));
    return report_published(flags.results, flags.out);
  }
  const Loaded loaded = load(flags.results);
  const Published numbers = printed_numbers();
  const auto sections = sections_of(loaded.results, numbers);
  const auto unknown = unknown_text(loaded.results);
  if (sections.empty()) refuse_empty(flags, loaded, unknown);
  const auto expected = expected_to_fail(flags.expected, registry(), sections);
  const fs::path target = flags.out.empty()
                              ? Folder(flags.results).make("report").path()
                              : fs::path(flags.out);
  const auto origin = provenance(loaded, sections, numbers);
  try {
    write_report(target,
                 sections,
                 origin,
                 {.one_file = flags.one_file, .groups = groups_of(numbers)});
    if (!flags.publish.empty())
      publish_campaign(flags.publish, loaded, sections, origin);
  } catch (const std::runtime_error& error) {
    throw EnvironmentError(error.what());
  }
  print_summary(sections, target, origin, unknown);
  if (flags.check) check_claims(tally(sections, expected));
  require_complete(loaded.lacks, kRunAgain);
  if (flags.check &&
      decided_by_runs(registry(), sections, loaded.results, numbers) == 0)
    throw ExitError(ExitCode::incomplete,
                    "incomplete: these runs decide no gating claim; run the "
                    "profile that the claims name");
  return ExitCode::good;
}

}  // namespace physinv
