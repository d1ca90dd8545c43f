#include "suite/app/sections.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "reports/joined_tables.h"
#include "reports/printed_curves.h"
#include "suite/app/installed.h"
#include "suite/evidence/budget_figures.h"
#include "suite/evidence/convergence_history.h"
#include "suite/evidence/failures.h"
#include "suite/evidence/method_titles.h"
#include "suite/evidence/performance_profiles.h"
#include "suite/evidence/standings.h"
#include "suite/evidence/status_table.h"
#include "suite/evidence/work_precision.h"
#include "suite/harness/judge.h"
#include "suite/harness/registry.h"
#include "suite/results/crowded.h"

namespace physinv {
namespace {

Section section_of(const Experiment& e,
                   const Results& results,
                   const Published& published) {
  Section section;
  if (e.report) section = e.report({results, published, e.name});
  section.experiment = e.name;
  section.title = e.title;
  section.paper = e.citation.paper;
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
    if (o.report) section = o.report({results, published, o.paper});
    section.experiment = section.paper = o.paper;
    section.title = o.title;
    section.claims = judge(o.claims, {results, published, o.paper}, o.profiles);
    sections.push_back(std::move(section));
  }
  return sections;
}

/// What the papers print of their curves.
std::vector<PrintedCurve> curves_of(const Published& published) {
  std::vector<std::string> papers;
  for (const Publication& p : published.publications()) papers.push_back(p.key);
  return papers.empty() ? std::vector<PrintedCurve>()
                        : printed_curves(published_directory(), papers);
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

/// CPU of all stages and, of that, what went to curves, metrics and final
/// losses. Writing them is not part of it.
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

/// Methods that the experiment's report does not name have the titles of the
/// literature.
void add_titles(const Results& results, Section& section) {
  for (const std::string& method : results.methods(section.experiment))
    section.method_titles.try_emplace(method, method_title(method));
}

/// What every experiment shows of all its methods.
void compare_methods(const Results& results,
                     const std::string& experiment,
                     Section& section) {
  const ProfileOptions named{.title = section.title,
                             .method_titles = section.method_titles};
  const CommonRuns common = common_runs(results, experiment);
  const auto add = [&](Figure figure) {
    if (!figure.panels.empty()) section.figures.push_back(std::move(figure));
  };
  add(solved_by_budget(common, named));
  add_work_precision(section, results, experiment, section.method_titles);
  add(learning_curves(results, experiment, named));
  add_standings(section, common, section.method_titles);
  if (Table ends = status_table(results, experiment, section.method_titles);
      !ends.rows.empty())
    section.tables.push_back(std::move(ends));
  for (Figure& figure : performance_profile_figures(common, named))
    section.figures.push_back(std::move(figure));
}

/// Rows of methods have their names.
void name_rows(Section& section) {
  for (Table& table : section.tables)
    if (table.corner == "method")
      for (TableRow& row : table.rows)
        if (const auto at = section.method_titles.find(row.label);
            at != section.method_titles.end())
          row.label = at->second;
}

}  // namespace

std::vector<Group> groups_of(const Published& published) {
  std::vector<Group> groups;
  const auto add = [&](const Publication& p) {
    groups.push_back(
        {.key = p.key,
         .title = p.title,
         .text = p.text(),
         .link = p.arxiv.empty() ? "" : "https://arxiv.org/abs/" + p.arxiv});
  };
  // The latest first; those that were built on come after.
  for (const std::string_view key : {"jpo", "hig", "sip", "physgrad"})
    if (const Publication* p = published.publication(key)) add(*p);
  for (const Publication& p : published.publications())
    if (std::none_of(groups.begin(), groups.end(), [&](const Group& g) {
          return g.key == p.key;
        }))
      add(p);
  std::map<std::string, std::string> others;
  for (const Overview& o : registry().overviews())
    if (published.publication(o.paper) == nullptr) others[o.paper] = o.title;
  for (const auto& [key, title] : others)
    groups.push_back({.key = key, .title = title, .text = {}, .link = {}});
  return groups;
}

Published printed_numbers() {
  const auto directory = published_directory();
  Published numbers(directory);
  if (const auto wrong = registry().unknown_printed(numbers); !wrong.empty())
    throw StoreError(
        fmt::format("{} lacks published numbers (restore its files): {}",
                    directory.string(),
                    fmt::join(wrong, "; ")));
  return numbers;
}

std::vector<Section> sections_of(const Results& results,
                                 const Published& published) {
  std::vector<Section> sections = overviews_of(results, published);
  const auto printed = curves_of(published);
  const auto work = work_of(results);
  std::vector<std::pair<const Experiment*, std::size_t>> own;
  for (const auto& e : registry().experiments()) {
    if (results.sizes(e->name).empty()) continue;
    own.emplace_back(e.get(), sections.size());
    sections.push_back(section_of(*e, results, published));
    if (const auto at = work.find(e->name); at != work.end())
      sections.back().work = at->second;
    if (Table failed = failed_runs(results, e->name); !failed.rows.empty())
      sections.back().tables.insert(sections.back().tables.begin(),
                                    std::move(failed));
    add_titles(results, sections.back());
    draw_printed(printed, sections.back());
  }
  for (const auto& [e, at] : own) {
    Section& section = sections[at];
    name_rows(section);
    if (!only_diagnoses(*e)) compare_methods(results, e->name, section);
    apply(e->styles, section.figures);
  }
  for (Section& overview : sections)
    if (overview.experiment == overview.paper)
      for (Table& table : joined_tables(sections, overview.paper))
        overview.tables.push_back(std::move(table));
  return sections;
}

nlohmann::ordered_json provenance(const Loaded& loaded,
                                  const std::vector<Section>& sections,
                                  const Published& published) {
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
  picked["papers"] = papers_of(sections, published);
  if (const auto text = crowded_text(loaded.results.cases()); !text.empty())
    picked["crowded"] = text;
  return picked;
}

}  // namespace physinv
