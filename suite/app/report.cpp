#include "reports/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "reports/digest.h"
#include "suite/app/installed.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/evidence/frontier.h"
#include "suite/harness/expected.h"
#include "suite/harness/judge.h"
#include "suite/harness/progress.h"
#include "suite/results/course.h"
#include "suite/results/crowded.h"
#include "suite/results/folder.h"
#include "suite/results/json.h"
#include "suite/results/profiles.h"
#include "suite/results/published.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

Section section_of(const Experiment& e,
                   const Results& results,
                   const Published& published) {
  Section section;
  if (e.report) section = e.report(results, published);
  section.experiment = e.name;
  section.title = e.title;
  section.paper = e.source.paper;
  for (auto& claim : judge(e, results, published))
    section.claims.push_back(std::move(claim));
  return section;
}

/// What a paper says about its experiments together, if one of them was run.
std::vector<Section> overviews_of(const Results& results,
                                  const Published& published) {
  std::vector<Section> sections;
  for (const Overview& o : registry().overviews()) {
    const auto& cases = results.cases();
    if (std::none_of(cases.begin(), cases.end(), [&](const CaseRecord& c) {
          return c.info.experiment.starts_with(o.paper + "/");
        }))
      continue;
    Section section;
    if (o.report) section = o.report(results, published);
    section.experiment = section.paper = o.paper;
    section.title = o.title;
    section.claims = judge(o.claims, {results, published, o.paper}, o.profiles);
    sections.push_back(std::move(section));
  }
  return sections;
}

/// Where the sections' experiments were published.
std::vector<std::string> papers_of(const std::vector<Section>& sections,
                                   const Published& published) {
  std::vector<std::string> papers;
  for (const Publication& p : published.publications())
    if (std::any_of(sections.begin(), sections.end(), [&](const Section& s) {
          return s.paper == p.key;
        }))
      papers.push_back(p.key + ": " + p.text());
  return papers;
}

/// Nothing is solved there, so nothing reaches a target.
bool only_diagnoses(const Experiment& e) {
  return std::all_of(
      e.methods.begin(), e.methods.end(), [](const Method& method) {
        return std::all_of(
            method.chain.begin(), method.chain.end(), [](const auto& stage) {
              return is_diagnostic(stage->options());
            });
      });
}

std::vector<Section> sections_of(const Results& results,
                                 const Published& published) {
  std::vector<Section> sections = overviews_of(results, published);
  for (const auto& e : registry().experiments()) {
    if (results.sizes(e->name).empty()) continue;
    Section section = section_of(*e, results, published);
    if (!only_diagnoses(*e)) {
      add_frontier(section, results, e->name, section.method_titles);
      for (Figure& figure :
           profile_figures(results,
                           e->name,
                           {.title = section.title,
                           .method_titles = section.method_titles}))
        section.figures.push_back(std::move(figure));
    }
    apply(e->looks, section.figures);
    sections.push_back(std::move(section));
  }
  return sections;
}

/// CPU of all stages and, of that, what went to curves, metrics and final
/// losses. Writing them down is no part of it.
void add_cpu(const Results& results, nlohmann::ordered_json& picked) {
  double stages = 0, evaluation = 0;
  for (const CaseRecord& c : results.cases()) {
    for (const StageRecord& s : c.stages) {
      stages += s.clocks.total().cpu;
      evaluation += s.clocks.measure.cpu;
    }
  }
  picked["stages_cpu_ms"] = std::round(1e3 * stages);
  picked["evaluation_ms"] = std::round(1e3 * evaluation);
}

/// "quick: 6 stages, smoke: 2 stages", where stages of several profiles are
/// there; empty if not.
std::string profiles_text(const Results& results) {
  std::map<std::string, int> stages;
  for (const CaseRecord& c : results.cases())
    for (const StageRecord& s : c.stages) ++stages[profile_of(c, s)];
  std::string text;
  for (const auto& [profile, count] : stages)
    text += fmt::format(
        "{}{}: {} stages", text.empty() ? "" : ", ", profile, count);
  return stages.size() > 1 ? text : "";
}

/// Context of the campaign as far as a report states it.
nlohmann::ordered_json provenance(const Loaded& loaded) {
  const auto& plan = loaded.catalog.plan;
  const auto none = nlohmann::json::object();
  const auto context = plan.is_object() ? plan.value("context", none) : none;
  nlohmann::ordered_json picked;
  if (plan.contains("profile")) picked["profile"] = plan["profile"];
  if (const auto text = profiles_text(loaded.results); !text.empty())
    picked["profiles"] = text;
  if (loaded.lacks.any()) picked["incomplete"] = to_text(loaded.lacks);
  for (const char* key : {"date",
                          "host_name",
                          "cpu_model",
                          "num_cpus",
                          "instruction_set",
                          "compiler",
                          "compiler_flags",
                          "build_type",
                          "fingerprint",
                          "version",
                          "git_revision",
                          "git_dirty",
                          "options"}) {
    if (context.contains(key)) picked[key] = context[key];
  }
  add_cpu(loaded.results, picked);
  return picked;
}

/// What a later campaign, and the page of results, can be made from; without
/// the directory that it lay in.
void publish_campaign(const fs::path& target,
                      const Loaded& loaded,
                      const std::vector<Section>& sections,
                      nlohmann::ordered_json provenance) {
  const auto forget_place = [](auto& context) {
    if (context.contains("options") && context["options"].is_object())
      context["options"].erase("out");
  };
  auto results = results_of(loaded);
  forget_place(results["context"]);
  forget_place(provenance);
  make_directory(target);
  const Folder folder(target);
  folder.write("results.json.gz", gzipped(results.dump(1)));
  auto digest = digest_json(sections, provenance);
  digest["checksum"] = checksum_of(digest);
  folder.write("digest.json", digest.dump(1) + '\n');
}

/// The list named by the flag, else the one beside the published numbers.
std::vector<ExpectedFailure> expected_failures(
    const std::string& named,
    const fs::path& published,
    const std::vector<Section>& sections) {
  const fs::path path = named.empty()
                            ? published.parent_path() / "expected_failures.json"
                            : fs::path(named);
  if (named.empty() && !fs::exists(path)) return {};
  if (!fs::is_regular_file(path))
    throw UsageError(fmt::format(
        "there is no file '{}' of expected failures; a JSON list of experiment,"
        " claim and reason is expected",
        path.string()));
  auto expected = read_expected(path);
  check_expected(expected, registry(), sections, path);
  return expected;
}

/// Says how the gating claims stand; ExitError if one fails unexpectedly.
void check_claims(const ClaimTally& j) {
  const auto failing =
      j.known_misses.size() + j.misses.size() + j.explained.size();
  fmt::print(
      "{} gating claims judged: {} hold, {} explained by their cause, {} fail "
      "as expected, {} fail\n",
      j.judged,
      j.judged - failing,
      j.explained.size(),
      j.known_misses.size(),
      j.misses.size());
  for (const auto& claim : j.explained) fmt::print("explained: {}\n", claim);
  for (const auto& claim : j.known_misses)
    fmt::print("expected to fail: {}\n", claim);
  for (const auto& claim : j.surprises)
    fmt::print("holds, although listed as expected to fail: {}\n", claim);
  for (const auto& claim : j.stale)
    fmt::print("holds, although its cause says: {}\n", claim);
  if (!j.misses.empty())
    throw ExitError(ExitCode::claim,
                    fmt::format("{} gating claims are not reproduced, first {}",
                                j.misses.size(),
                                j.misses.front()));
}

}  // namespace

ExitCode report_verb(const Arguments& arguments) {
  std::string results, out, expected, publish;
  bool check = false;
  if (!parse(
          "report",
          "Writes tables, plots and claims of a finished campaign. Exit 10 "
          "if the campaign is incomplete.",
          {{"RESULTS", "directory that 'run' wrote", &results},
           {"--out", "where to; default: RESULTS/report", &out, "DIR"},
           {"--publish",
            "also keep results.json (compressed) and a digest of claims and "
            "tables there, for the verb 'results'",
            &publish,
            "DIR"},
           {"--check",
            "exit 7 if a gating claim is not reproduced and not expected to "
            "fail, 10 if none could be judged",
            &check},
           {"--expected",
            "claims expected to fail; default: reports/expected_failures.json",
            &expected,
            "FILE"}},
          arguments))
    return ExitCode::good;
  const Loaded loaded = load(results);
  const fs::path published = published_directory();
  const Published numbers(published);
  if (const auto wrong = registry().unknown_printed(numbers); !wrong.empty())
    throw StoreError(fmt::format("{} lacks numbers (restore its files): {}",
                                 published.string(),
                                 fmt::join(wrong, "; ")));
  const auto sections = sections_of(loaded.results, numbers);
  if (sections.empty()) {
    require_complete(loaded.lacks, kRunAgain);
    throw ExitError(ExitCode::nothing_matched,
                    "no experiment that declares a report has results in '" +
                        results + "'; run cases first");
  }
  const auto listed = check || !expected.empty()
                          ? expected_failures(expected, published, sections)
                          : std::vector<ExpectedFailure>();
  const fs::path target =
      out.empty() ? Folder(results).make("report").path() : fs::path(out);
  auto origin = provenance(loaded);
  origin["papers"] = papers_of(sections, numbers);
  const auto crowded = crowded_text(loaded.results.cases());
  if (!crowded.empty()) origin["crowded"] = crowded;
  try {
    write_report(target, sections, origin);
    if (!publish.empty()) publish_campaign(publish, loaded, sections, origin);
  } catch (const std::runtime_error& error) {
    throw EnvironmentError(error.what());
  }
  fmt::print(
      "{}report: {}\n",
      render_claims_text(sections,
                         static_cast<std::size_t>(Screen::of(stdout).columns)),
      (target / "index.html").string());
  if (!crowded.empty()) fmt::print("{}\n", crowded);
  const auto judgement = compare(sections, listed, origin.value("profile", ""));
  if (check) check_claims(judgement);
  require_complete(loaded.lacks, kRunAgain);
  if (check && judgement.judged == 0)
    throw ExitError(ExitCode::incomplete,
                    "incomplete: no gating claim could be judged; run the "
                    "profile that a claim names");
  return ExitCode::good;
}

}  // namespace physinv
