#include "reports/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "reports/digest.h"
#include "suite/app/installed.h"
#include "suite/app/options.h"
#include "suite/harness/progress.h"
#include "suite/results/file.h"
#include "suite/results/profiles.h"
#include "suite/results/published.h"
#include "suite/results/store.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

Section section_of(const Experiment& e,
                   const Results& results,
                   const Published& published) {
  Section section;
  if (e.report) section = e.report(results, published);
  apply(e.looks, section.figures);
  section.experiment = e.name;
  section.title = e.title;
  section.paper = e.source.paper;
  std::vector<std::string> profiles;
  for (const Profile& p : e.profiles) profiles.push_back(p.name);
  for (auto& claim : judge(e.claims, {results, published, e.name}, profiles))
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
    sections.push_back(
        {.experiment = o.paper,
         .title = o.title,
         .paper = o.paper,
         .claims = judge(o.claims, {results, published, o.paper}, o.profiles)});
  }
  return sections;
}

std::vector<Section> sections_of(const Results& results,
                                 const Published& published) {
  std::vector<Section> sections = overviews_of(results, published);
  for (const auto& e : registry().experiments()) {
    if (results.sizes(e->name).empty()) continue;
    Section section = section_of(*e, results, published);
    for (Figure& figure :
         profile_figures(results,
                         e->name,
                         {.title = section.title,
                         .method_titles = section.method_titles})) {
      section.figures.push_back(std::move(figure));
    }
    sections.push_back(std::move(section));
  }
  return sections;
}

/// Context of the campaign as far as a report states it.
nlohmann::ordered_json provenance(const fs::path& directory) {
  const Store store = Store::read_only(directory);
  const auto& plan = store.catalog().plan;
  const auto context = plan.value("context", nlohmann::json::object());
  nlohmann::ordered_json picked;
  if (plan.contains("profile")) picked["profile"] = plan["profile"];
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
  return picked;
}

/// What a later campaign, and the page of results, can be made from.
void publish_campaign(const fs::path& target,
                      const fs::path& directory,
                      const std::vector<Section>& sections,
                      const nlohmann::ordered_json& provenance) {
  make_directory(target);
  write_atomically(target / "results.json.gz",
                   gzipped(read_file(directory / "results.json")));
  write_atomically(target / "digest.json",
                   digest_json(sections, provenance).dump(1) + '\n');
}

std::vector<std::string> unmet(const std::vector<Section>& sections) {
  std::vector<std::string> ids;
  for (const Section& s : sections) {
    for (const ClaimResult& c : s.claims)
      if (c.gates && c.verdict == Verdict::not_reproduced)
        ids.push_back(s.experiment + " " + c.id + ": " + c.says);
  }
  return ids;
}

}  // namespace

ExitCode report_verb(const Arguments& arguments) {
  std::string results_text, out;
  std::string publish;
  bool check = false;
  if (!parse(
          "physinv-bench report",
          "Writes tables, plots and claims of a finished campaign.",
          {{"RESULTS", "directory that 'run' wrote", &results_text},
           {"--out", "where to; default: RESULTS/report", &out, "DIR"},
           {"--publish",
            "also keep results.json (compressed) and a digest of claims and "
            "tables there, for the verb 'results'",
            &publish,
            "DIR"},
           {"--check", "exit 7 if a gating claim is not reproduced", &check}},
          arguments))
    return ExitCode::good;
  const fs::path directory = results_directory(results_text);
  const Results results = load_results(directory);
  const Published numbers(published_directory());
  if (const auto wrong = registry().unknown_printed(numbers); !wrong.empty())
    throw std::logic_error(fmt::format("{}", fmt::join(wrong, "; ")));
  const auto sections = sections_of(results, numbers);
  if (sections.empty())
    throw ExitError(ExitCode::nothing_matched,
                    "no experiment that declares a report has results in '" +
                        results_text + "'; run cases first");
  const fs::path target = out.empty() ? directory / "report" : fs::path(out);
  try {
    write_report(target, sections, provenance(directory));
    if (!publish.empty())
      publish_campaign(publish, directory, sections, provenance(directory));
  } catch (const std::runtime_error& error) {
    throw EnvironmentError(error.what());
  }
  fmt::print(
      "{}report: {}\n",
      render_claims_text(sections,
                         static_cast<std::size_t>(Screen::of(stdout).columns)),
      (target / "index.html").string());
  const auto wrong = unmet(sections);
  if (check && !wrong.empty())
    throw ExitError(ExitCode::claim,
                    fmt::format("{} gating claims are not reproduced, first {}",
                                wrong.size(),
                                wrong.front()));
  return ExitCode::good;
}

}  // namespace physinv
