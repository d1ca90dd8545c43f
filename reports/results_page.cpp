#include "reports/results_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>

#include "reports/latest_claims.h"
#include "reports/report.h"
#include "reports/statements.h"
#include "suite/results/markdown.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

/// Of a table's rows.
constexpr std::array kOrder{Verdict::not_reproduced,
                            Verdict::contradiction,
                            Verdict::depends,
                            Verdict::weaker,
                            Verdict::stronger,
                            Verdict::differs,
                            Verdict::partly_judged,
                            Verdict::not_judged};

std::string page_link(const std::string& experiment,
                      const std::string& text,
                      const std::string& pages) {
  return fmt::format("[{}]({}{}.md)",
                     markdown(text),
                     pages.empty() ? "" : pages + "/",
                     folder_of(experiment));
}

std::string paper_name(const std::string& key) {
  return key.empty() ? "(none)" : markdown(key);
}

/// A column of counts: of claims with one of these verdicts.
struct CountColumn {
  const char* head;
  std::vector<Verdict> verdicts;
};

const CountColumn kUndecided{
    "undecided",
    {Verdict::partly_judged, Verdict::not_judged, Verdict::reported}};

/// A row for each paper.
std::string counts_table(const Papers& papers,
                         Origin origin,
                         const std::vector<CountColumn>& columns) {
  std::string out = "| paper |", line = "| --- |";
  for (const CountColumn& column : columns) {
    out += fmt::format(" {} |", column.head);
    line += " --- |";
  }
  out += '\n' + line + '\n';
  for (const auto& [paper, claims] : papers) {
    const VerdictCounts counts = counts_of(claims, origin);
    out += fmt::format("| {} |", paper_name(paper));
    for (const CountColumn& column : columns) {
      int sum = 0;
      for (const Verdict v : column.verdicts)
        sum += counts[static_cast<std::size_t>(v)];
      out += fmt::format(" {} |", sum);
    }
    out += '\n';
  }
  return out;
}

/// The condition that a row shows; of a claim that only reports, its first
/// number.
const ConditionResult* shown(const ClaimResult& claim) {
  if (const ConditionResult* c = telling(claim)) return c;
  for (const ConditionResult& c : claim.conditions)
    if (c.value) return &c;
  return nullptr;
}

/// "75.3 ± 4.03 (mean of the four, %: printed 68.5 +- 4.37)"
std::string measured(const ClaimResult& claim) {
  const ConditionResult* c = shown(claim);
  if (c == nullptr) return "";
  std::string value = "not run";
  if (c->value) value = value_text(*c->value);
  if (c->spread) value += " ± " + value_text(*c->spread);
  return markdown(fmt::format("{} ({}{}{})",
                              value,
                              c->label,
                              c->bounds.empty() ? "" : ": ",
                              c->bounds));
}

std::string row(const ClaimKey& key,
                const ClaimResult& claim,
                const std::string& pages) {
  return fmt::format("| {} {} | {} | {} | {} | {} |\n",
                     page_link(key.first, key.first, pages),
                     markdown(key.second),
                     markdown(claim.says),
                     measured(claim),
                     words_of(claim.verdict),
                     markdown(claim.cause.empty() ? "unknown" : claim.cause));
}

bool is_study(const ClaimKey& key) { return key.first.starts_with("studies/"); }

/// The claims that are neither met nor only reported; empty if there are none.
std::string table_of(const Papers& papers,
                     Origin origin,
                     const std::string& pages) {
  std::string rows;
  for (const Verdict v : kOrder)
    for (const auto& [paper, all] : papers)
      for (const auto& [key, s] : all)
        if (s.claim.origin == origin && s.claim.verdict == v && !is_study(key))
          rows += row(key, s.claim, pages);
  if (rows.empty()) return "";
  return "\n| claim | says | measured (condition) | verdict | cause |\n"
         "| --- | --- | --- | --- | --- |\n" +
         rows;
}

/// Of a study, a number of each setting: "A 75 ± 4; B 42: no (each > 50)".
std::string every_measured(const ClaimResult& claim) {
  std::vector<std::string> numbers;
  std::set<std::string> bounds;
  for (const ConditionResult& c : claim.conditions) {
    if (!c.value || c.bounds.empty()) continue;
    std::string number = c.text() + ' ' + value_text(*c.value);
    if (c.spread) number += " ± " + value_text(*c.spread);
    if (!c.holds.value_or(true)) number += ": no";
    numbers.push_back(std::move(number));
    bounds.insert(c.bounds);
  }
  if (numbers.empty()) return "not run";
  std::string out = fmt::format("{}", fmt::join(numbers, "; "));
  if (bounds.size() == 1) out += " (each " + *bounds.begin() + ')';
  return markdown(out);
}

/// The paper's question, and its main statements with what was measured.
std::string answer(const Publication& paper,
                   const LatestClaims& claims,
                   const ResultsLinks& links) {
  std::string out = fmt::format("\n**{}** ({}). {}",
                                markdown(paper.title),
                                markdown(paper.key),
                                markdown(paper.question));
  for (const ClaimKey& key : paper.main_claims) {
    const auto found = claims.find(key);
    if (found == claims.end()) continue;
    const ClaimResult& claim = found->second.claim;
    out += fmt::format(
        " {}: **{} {}**, {}, {}.",
        markdown(claim.says),
        mark_of(claim.verdict),
        words_of(claim.verdict),
        is_study(key) ? every_measured(claim) : measured(claim),
        page_link(key.first, key.first + ' ' + key.second, links.pages));
  }
  return out + '\n';
}

std::string answers(const Papers& papers,
                    const std::vector<Publication>& publications,
                    const ResultsLinks& links) {
  std::string out;
  for (const Publication& p : publications)
    if (const auto found = papers.find(p.key);
        found != papers.end() && !p.main_claims.empty())
      out += answer(p, found->second, links);
  return out.empty() ? "" : "\n## Answers\n" + out;
}

/// Hours, machines and revisions of the campaigns that ran a paper's cases.
std::string spent(const std::string& paper,
                  const std::vector<NamedDigest>& campaigns) {
  constexpr double kSecondsAnHour = 3600;
  double seconds = 0;
  std::set<std::string> machines, revisions;
  int count = 0;
  for (const NamedDigest& c : campaigns) {
    bool any = false;
    for (const auto& [experiment, cpu] : c.cpu_seconds)
      if (experiment.starts_with(paper + "/")) seconds += cpu, any = true;
    if (!any) continue;
    const Json& p = c.digest.at("provenance");
    machines.insert(text_of(p, "cpu_model"));
    revisions.insert(text_of(p, "git_revision").substr(0, 8));
    ++count;
  }
  if (count == 0) return "";
  return fmt::format("| {} | {} | {} | {:.2f} | {} |\n",
                     paper_name(paper),
                     count,
                     revisions.size(),
                     seconds / kSecondsAnHour,
                     markdown(fmt::format("{}", fmt::join(machines, ", "))));
}

std::string runs(const Papers& papers,
                 const std::vector<NamedDigest>& campaigns) {
  std::string rows;
  for (const auto& [paper, claims] : papers) rows += spent(paper, campaigns);
  if (rows.empty()) return "";
  return "\n## Runs\n\n| paper | campaigns | revisions | CPU-hours of solving "
         "| "
         "machines |\n| --- | --- | --- | --- | --- |\n" +
         rows;
}

/// Links to the pages of a paper's experiments, with how many of the
/// statements there are reproduced.
std::string experiments(const std::vector<NamedDigest>& campaigns,
                        const Papers& papers,
                        const ResultsLinks& links) {
  std::map<std::string, std::map<std::string, std::array<int, 2>>> pages;
  for (const NamedDigest& c : campaigns)
    for (const Json& section : c.digest.at("sections")) {
      const auto name = section.at("experiment").get<std::string>();
      pages[name.substr(0, name.find('/'))][name] = {};
    }
  for (const auto& [paper, claims] : papers)
    for (const auto& [key, s] : claims) {
      if (s.claim.origin != Origin::paper) continue;
      auto& counts = pages[key.first.substr(0, key.first.find('/'))][key.first];
      ++counts[1], counts[0] += s.claim.verdict == Verdict::reproduced;
    }
  std::string out;
  for (const auto& [group, names] : pages) {
    std::string line;
    for (const auto& [name, counts] : names) {
      const std::string text =
          name == group ? "all together" : name.substr(name.find('/') + 1);
      line += (line.empty() ? "" : ", ") + page_link(name, text, links.pages);
      if (counts[1] > 0) line += fmt::format(" {} of {}", counts[0], counts[1]);
    }
    out += fmt::format("- {}: {}\n", markdown(group), line);
  }
  return out;
}

/// The results of studies, in a paragraph.
std::string studies_line(const Papers& papers, const ResultsLinks& links) {
  std::string out, last;
  for (const auto& [paper, all] : papers)
    for (const auto& [key, s] : all)
      if (is_study(key)) {
        const std::string name = key.first.substr(key.first.find('/') + 1);
        out += key.first == last
                   ? ", "
                   : (out.empty() ? "" : "; ") +
                         page_link(key.first, name, links.pages) + ' ';
        out += words_of(s.claim.verdict);
        last = key.first;
      }
  if (out.empty()) return "";
  return "- Studies vary settings that the papers do not print: " + out + "\n";
}

template <class Page>
std::string checked(Page&& page) {
  try {
    return page();
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string("not a digest of a campaign: ") +
                             error.what());
  }
}

std::string section(const char* title, const std::string& body) {
  return body.empty() ? "" : fmt::format("\n## {}\n{}", title, body);
}

}  // namespace

std::string results_markdown(const std::vector<NamedDigest>& campaigns,
                             const std::vector<Publication>& publications,
                             const ResultsLinks& links) {
  return checked([&] {
    const auto papers = latest_claims(campaigns);
    return fmt::format(
               "# Results\n\n{} from the numbers that the campaigns under "
               "`reports/campaigns` stored. [Verdicts](docs/verdicts.md) "
               "defines the words. Each verdict comes from the newest campaign "
               "that decides it, or from an older one with more cases. A row "
               "shows the first condition that is not met, or, if all are "
               "met, the first one; the linked page has all of them. "
               "[Regression checks]({}/{}) are listed separately.\n",
               kWrittenByResults,
               links.pages,
               kChecksPage) +
           answers(papers, publications, links) + '\n' +
           counts_table(
               papers,
               Origin::paper,
               {{"reproduced", {Verdict::reproduced}},
                {"differs",
                 {Verdict::stronger, Verdict::weaker, Verdict::differs}},
                {"depends or contradiction",
                 {Verdict::depends, Verdict::contradiction}},
                {"not reproduced", {Verdict::not_reproduced}},
                kUndecided}) +
           section("Statements that are not reproduced or undecided, and why",
                   table_of(papers, Origin::paper, links.pages)) +
           section("Pages of experiments, with reproduced of all statements",
                   '\n' + experiments(campaigns, papers, links)) +
           studies_line(papers, links) + runs(papers, campaigns);
  });
}

std::string checks_markdown(const std::vector<NamedDigest>& campaigns,
                            const ResultsLinks& links) {
  return checked([&] {
    const auto papers = latest_claims(campaigns);
    return fmt::format(
               "# Regression checks\n\n{}; back to [all results]({}). A "
               "regression check is a range that earlier runs of this suite, "
               "or an independent program, gave for a number. Pages of "
               "experiments list all of them.\n\n",
               kWrittenByResults,
               links.overview) +
           counts_table(papers,
                        Origin::suite,
                        {{"reproduced", {Verdict::reproduced}},
                         {"differs, depends or contradiction",
                          {Verdict::stronger,
                           Verdict::weaker,
                           Verdict::differs,
                           Verdict::depends,
                           Verdict::contradiction}},
                         {"not reproduced", {Verdict::not_reproduced}},
                         kUndecided}) +
           table_of(papers, Origin::suite, "");
  });
}

}  // namespace physinv
