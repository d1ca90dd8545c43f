#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "reports/digest.h"
#include "reports/report.h"
#include "reports/tables.h"
#include "suite/app/installed.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/app/published_campaign.h"
#include "suite/app/sections.h"
#include "suite/compare/comparison.h"
#include "suite/compare/pages.h"
#include "suite/compare/ranks.h"
#include "suite/compare/regressions.h"
#include "suite/compare/summary.h"
#include "suite/harness/judge.h"
#include "suite/harness/registry.h"
#include "suite/harness/screen.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

struct CompareFlags {
  std::vector<std::string> sides, fail_on;
  std::string by = "seed", format = "text", out;
  Thresholds thresholds;
  int lines = 30;
  bool one_file = false;
};

std::vector<JudgedClaim> claims_of(const Results& results,
                                   const Published& published) {
  std::vector<JudgedClaim> all;
  for (const Overview& o : registry().overviews())
    for (auto& c : judge(o.claims, {results, published, o.paper}, o.profiles))
      all.push_back({o.paper, std::move(c)});
  for (const auto& e : registry().experiments())
    if (!results.sizes(e->name).empty())
      for (auto& c : judge(*e, results, published))
        all.push_back({e->name, std::move(c)});
  return all;
}

/// "LABEL=DIR", or a directory that is its own label.
/// `judged`: with claims.
Side read_side(const std::string& text,
               const Published& published,
               bool judged) {
  const auto at = text.find('=');
  const bool labelled = at != std::string::npos && !is_folder(text);
  const std::string folder = labelled ? text.substr(at + 1) : text;
  Side side{.label = labelled ? text.substr(0, at) : text,
            .results = {},
            .claims = {}};
  if (is_published(folder)) {
    side.results = published_results(folder);
    const auto digest = published_digest(folder, published).digest;
    for (const Section& section : sections_of(digest))
      for (const ClaimResult& claim : section.claims)
        side.claims.push_back({section.experiment, claim});
  } else {
    side.results = load(folder).results;
    if (judged) side.claims = claims_of(side.results, published);
  }
  return side;
}

std::vector<Side> read_sides(const CompareFlags& flags) {
  std::vector<Side> sides;
  const Published published(published_directory());
  const bool by_commit = flags.by == "commit";
  for (const auto& text : flags.sides)
    sides.push_back(read_side(text, published, !by_commit));
  if (by_commit) {
    sides = sides_by_revision(sides);
    for (Side& side : sides) side.claims = claims_of(side.results, published);
  }
  if (sides.size() < 2)
    throw UsageError(
        by_commit
            ? "all stages are from one commit; compare needs results of two"
            : "compare needs two or more folders, or one folder with several "
              "commits and --by=commit");
  return sides;
}

By parse_by(const std::string& text) {
  if (text == "method") return By::method;
  if (text == "n") return By::n;
  if (text == "seed" || text == "commit") return By::seed;
  throw UsageError(fmt::format(
      "--by={} is unknown; known values: method, n, seed, commit", text));
}

std::vector<Aspect> parse_fail_on(const std::vector<std::string>& words) {
  std::vector<Aspect> all;
  for (const auto& word : words) {
    const auto aspect = aspect_of(word);
    if (!aspect)
      throw UsageError(fmt::format(
          "--fail-on={} is unknown; known values: {}", word, kAspects));
    all.push_back(*aspect);
  }
  return all;
}

/// Ends the program if anything of --fail-on got worse.
void refuse_worse(const CompareFlags& flags,
                  const std::vector<Aspect>& aspects,
                  const Comparison& c,
                  const std::vector<ChangedClaim>& claims) {
  std::string worse;
  bool of_time = true;
  for (std::size_t i = 0; i < aspects.size(); ++i) {
    const auto found =
        regression(aspects[i], c, claims, flags.thresholds.factor);
    if (!found) continue;
    of_time = of_time && found->of_time;
    worse += fmt::format("{}{} ({})",
                         worse.empty() ? "" : ", ",
                         flags.fail_on[i],
                         found->text());
  }
  if (!worse.empty())
    throw ExitError(
        of_time ? ExitCode::slower : ExitCode::accuracy,
        fmt::format("worse than {}: {} (--fail-on)", c.labels.front(), worse));
}

/// The one that compares so.
std::string command_text(const CompareFlags& flags) {
  return fmt::format("./bench compare {} --by={} --out={}",
                     fmt::join(flags.sides, " "),
                     flags.by,
                     flags.out);
}

/// Labels come from the command line, in whatever characters.
std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(
      1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// Of claims, those that both sides judge; prints how many only one does.
void print_counts(const Comparison& own,
                  const std::vector<ChangedClaim>& changed,
                  std::size_t judged) {
  const auto same =
      std::count_if(own.rows.begin(), own.rows.end(), [](auto& row) {
        return std::all_of(row.sides.begin(), row.sides.end(), [](auto& r) {
          return r && r->same_bits == r->stages;
        });
      });
  if (changed.size() > judged)
    fmt::print("{} claims are judged in one folder but not in another\n",
               changed.size() - judged);
  fmt::print("{}\n", pairs_text(own));
  fmt::print(
      "{} lines compared, {} with the same bits everywhere; {} claims "
      "changed their verdict\n",
      own.rows.size(),
      same,
      judged);
}

void print(const CompareFlags& flags,
           const Comparison& c,
           const std::vector<ChangedClaim>& changed,
           const std::vector<SideRank>& ranks) {
  const Comparison own = common(c);
  if (flags.format == "json") {
    fmt::print("{}\n", json_text(to_json(c, changed, ranks)));
    return;
  }
  if (flags.format == "csv") {
    fmt::print("{}", to_csv(changes_table(c, c.rows.size())));
    return;
  }
  const bool markdown = flags.format == "markdown";
  const auto claims = judged_everywhere(changed);
  const auto differing = static_cast<std::size_t>(
      std::count_if(ranks.begin(), ranks.end(), [](const auto& rank) {
        return rank.differs();
      }));
  const auto lines = static_cast<std::size_t>(flags.lines);
  const auto methods = method_changes(own, ranks);
  for (const auto& line : summary_sentences(methods, own))
    fmt::print("{}\n\n", line);
  for (const Table& table :
       {method_table(methods, own, lines),
        folded_table(own, lines),
        rank_table(ranks, c.labels, std::min(lines, differing)),
        missing_table(c),
        claims_table(claims, c.labels)})
    if (!table.rows.empty())
      fmt::print("{}\n",
                 markdown ? to_markdown(table)
                          : render_text(table, Screen::of(stdout).room()));
  fmt::print("{}\n", unchanged_text(own));
  print_counts(own, changed, claims.size());
}

/// The pages of --out.
void write_pages(const CompareFlags& flags,
                 const std::vector<Side>& sides,
                 const Comparison& c,
                 const std::vector<ChangedClaim>& claims,
                 const std::vector<SideRank>& ranks) {
  nlohmann::ordered_json origin{{"heading", "Campaigns compared"},
                                {"sides", c.labels},
                                {"by", flags.by},
                                {"command", command_text(flags)}};
  auto sections = compare_sections(c, sides, claims, ranks);
  for (Section& section : sections)
    if (const auto e = registry().find(section.experiment))
      section.title = e->title;
  write_report(flags.out,
               sections,
               origin,
               {.one_file = flags.one_file,
                .groups = groups_of(printed_numbers()),
                .front = 1});
  if (flags.format == "text")
    fmt::print("report: {}\n", (fs::path(flags.out) / "index.html").string());
}

void check_format(const CompareFlags& flags) {
  const std::vector<std::string> formats = {"text", "markdown", "csv", "json"};
  if (std::find(formats.begin(), formats.end(), flags.format) == formats.end())
    throw UsageError(fmt::format(
        "--format={} is unknown; known values: text, markdown, csv, json",
        flags.format));
}

/// False if help was asked for.
bool parse_flags(const Arguments& arguments, CompareFlags& flags) {
  return parse(
      "compare",
      "Compares two or more result folders: one sentence says which methods "
      "changed and how, then tables list methods and runs that changed: "
      "losses, ends, times, work and claims. Runs are paired by experiment, "
      "method, n and seed. Times and work are compared between stages that "
      "both converged or used all their iterations; a stage that fails, is "
      "skipped or diverges has none. CPU time is compared if both ran on one "
      "thread, otherwise wall time unless one stage was crowded; of "
      "repetitions (run --benchmark_repetitions), the median counts. The "
      "exit code is 0 unless --fail-on is given.",
      {{"RESULTS",
        "directories that 'run' or 'report --publish' wrote, or "
        "LABEL=DIRECTORY; the first one is the reference",
        &flags.sides},
       {"--by",
        "seed (every run, the default), n (over seeds), method (over n "
        "and seeds): ratios are medians over pairs of runs, with the "
        "worst pair; commit (sides are revisions instead of folders)",
        &flags.by,
        "WHAT"},
       {"--format",
        "text (default), markdown, csv or json",
        &flags.format,
        "FORMAT"},
       {"--out",
        "also write a report there: HTML, Markdown, tables as CSV and "
        "JSON, losses over time, performance profiles, running times, "
        "ranks",
        &flags.out,
        "DIR"},
       {"--one-file",
        "with --out: write one page that contains everything",
        &flags.one_file},
       {"--lines", "rows of a table at most (default 30)", &flags.lines},
       {"--fail-on",
        fmt::format("exit 5 if this got worse in any pair of runs, 6 if only "
                    "time did; a stage that ends worse also counts for time "
                    "and work; can be repeated: {}",
                    kAspects),
        &flags.fail_on,
        "WHAT"},
       {"--factor",
        fmt::format("ratio from which a loss or time counts as worse for "
                    "--fail-on, and a time as changed (default 1.5); losses "
                    "below {:g} and times below {:g} ms count as equal",
                    kEqualLoss,
                    1e3 * kShortTime),
        &flags.thresholds.factor},
       {"--solved",
        "loss at most which an example counts as solved (default 1e-6)",
        &flags.thresholds.solved,
        "LOSS"}},
      arguments);
}

}  // namespace

ExitCode compare_verb(const Arguments& arguments) {
  CompareFlags flags;
  if (!parse_flags(arguments, flags)) return ExitCode::good;
  const By by = parse_by(flags.by);
  check_format(flags);
  const auto aspects = parse_fail_on(flags.fail_on);
  const auto sides = read_sides(flags);
  const Comparison c = compare(sides, by, flags.thresholds);
  if (std::all_of(c.rows.begin(), c.rows.end(), [](const auto& row) {
        return row.missing();
      }))
    throw ExitError(ExitCode::nothing_matched,
                    "the folders have no run in common; runs are paired by "
                    "experiment, method, n and seed");
  const auto claims = changed_claims(sides);
  const auto ranks = side_ranks(sides);
  print(flags, c, claims, ranks);
  if (!flags.out.empty()) write_pages(flags, sides, c, claims, ranks);
  refuse_worse(flags, aspects, c, claims);
  return ExitCode::good;
}

}  // namespace physinv
