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

/// What fails stands first.
constexpr std::array kOrder{Verdict::not_reproduced,
                            Verdict::contradiction,
                            Verdict::depends,
                            Verdict::differs,
                            Verdict::partly_judged,
                            Verdict::not_judged,
                            Verdict::reported,
                            Verdict::reproduced};
static_assert(kOrder.size() == kVerdictCount);

constexpr std::array kOrigins{Origin::paper, Origin::suite};

std::string overview(const Papers& papers) {
  std::array<VerdictCounts, 2> totals{};
  for (const auto& [paper, claims] : papers)
    for (std::size_t o = 0; o < kOrigins.size(); ++o)
      for (const Verdict v : kVerdicts)
        totals[o][static_cast<std::size_t>(v)] +=
            counts_of(claims, kOrigins[o])[static_cast<std::size_t>(v)];
  std::string out = "| paper |", line = "\n| --- |";
  for (std::size_t o = 0; o < kOrigins.size(); ++o)
    for (const Verdict v : columns_of(totals[o])) {
      const bool first_range =
          kOrigins[o] == Origin::suite && v == kVerdicts[0];
      out += fmt::format(" {}{} |",
                         first_range ? "ranges of the suite: " : "",
                         words_of(v, kOrigins[o]));
      line += " --- |";
    }
  out += line + '\n';
  for (const auto& [paper, c] : papers) {
    out += fmt::format("| {} |", paper.empty() ? "(none)" : markdown(paper));
    for (std::size_t o = 0; o < kOrigins.size(); ++o)
      for (const Verdict v : columns_of(totals[o]))
        out += fmt::format(
            " {} |", counts_of(c, kOrigins[o])[static_cast<std::size_t>(v)]);
    out += '\n';
  }
  return out;
}

/// What the row shows of all conditions; of a claim that only reports, its
/// first number.
const ConditionResult* shown(const ClaimResult& claim) {
  if (const ConditionResult* c = telling(claim)) return c;
  for (const ConditionResult& c : claim.conditions)
    if (c.value) return &c;
  return nullptr;
}

std::string asked(const ClaimResult& claim) {
  const ConditionResult* c = shown(claim);
  if (c == nullptr) return "";
  return c->bounds.empty() ? c->label : c->label + " " + c->bounds;
}

std::string measured(const ClaimResult& claim) {
  const ConditionResult* c = shown(claim);
  if (c == nullptr || !c->value) return "";
  std::string text = value_text(*c->value);
  if (c->spread) text += " ± " + value_text(*c->spread);
  return text;
}

std::string row(const ClaimKey& key,
                const LatestClaim& s,
                const ResultsLinks& links) {
  std::string cause = s.claim.cause;
  if (cause.empty() && s.claim.verdict != Verdict::reproduced)
    cause = "unknown";
  return fmt::format("| [{}]({}/{}.md) {} | {} | {} | {} | {} | {} | {} |\n",
                     markdown(key.first),
                     links.pages,
                     folder_of(key.first),
                     markdown(key.second),
                     markdown(s.claim.says),
                     words_of(s.claim.verdict, s.claim.origin),
                     markdown(asked(s.claim)),
                     markdown(measured(s.claim)),
                     markdown(cause),
                     markdown(s.campaign));
}

constexpr const char* kHead =
    "\n| claim | says | verdict | asked | measured | cause | campaign |\n"
    "| --- | --- | --- | --- | --- | --- | --- |\n";

bool is_study(const ClaimKey& key) { return key.first.starts_with("studies/"); }

/// Claims of an origin, those of `but` and of studies left out.
std::string rows_of(const LatestClaims& all,
                    Origin origin,
                    const std::set<Verdict>& but,
                    const ResultsLinks& links) {
  std::string rows;
  for (const Verdict v : kOrder)
    for (const auto& [key, s] : all)
      if (s.claim.origin == origin && s.claim.verdict == v &&
          !but.contains(v) && !is_study(key))
        rows += row(key, s, links);
  return rows;
}

/// What a publication is called in the provenance of some campaign.
std::string publication(const std::string& paper,
                        const std::vector<NamedDigest>& campaigns) {
  for (const NamedDigest& c : campaigns)
    for (const Json& text :
         c.digest.at("provenance").value("papers", Json::array()))
      if (text.get<std::string>().starts_with(paper + ": "))
        return text.get<std::string>().substr(paper.size() + 2);
  return "";
}

/// Hours, machines and revisions of the campaigns that ran a paper's cases.
std::string spent(const std::string& paper,
                  const std::vector<NamedDigest>& campaigns) {
  constexpr double kSecondsAnHour = 3600;
  double seconds = 0;
  std::set<std::string> machines;
  std::vector<std::string> revisions;
  int count = 0;
  for (const NamedDigest& c : newest_first(campaigns)) {
    bool any = false;
    for (const auto& [experiment, cpu] : c.cpu_seconds)
      if (experiment.starts_with(paper + "/")) seconds += cpu, any = true;
    if (!any) continue;
    const Json& p = c.digest.at("provenance");
    machines.insert(text_of(p, "cpu_model"));
    const std::string revision = text_of(p, "git_revision").substr(0, 8);
    if (std::find(revisions.begin(), revisions.end(), revision) ==
        revisions.end())
      revisions.push_back(revision);
    ++count;
  }
  if (count == 0) return "";
  return fmt::format(
      "{} campaigns, {:.2f} CPU-hours of solving, {}; revisions {}.\n",
      count,
      seconds / kSecondsAnHour,
      markdown(fmt::format("{}", fmt::join(machines, ", "))),
      markdown(fmt::format("{}", fmt::join(revisions, ", "))));
}

/// Links to pages of experiments about which no claim is shown above.
std::string others(const std::vector<NamedDigest>& campaigns,
                   const ResultsLinks& links) {
  std::map<std::string, bool> stated;
  for (const NamedDigest& c : campaigns)
    for (const Json& section : c.digest.at("sections")) {
      bool& any = stated[section.at("experiment").get<std::string>()];
      for (const Json& claim : section.at("claims"))
        any = any || claim_from(claim).origin == Origin::paper;
    }
  std::string out;
  for (const auto& [experiment, any] : stated)
    if (!any)
      out += fmt::format("{}[{}]({}/{}.md)",
                         out.empty() ? "" : ", ",
                         markdown(experiment),
                         links.pages,
                         folder_of(experiment));
  return out.empty() ? "" : "\nPages without a statement: " + out + ".\n";
}

/// What studies came to, in a paragraph.
std::string studies_line(const Papers& papers, const ResultsLinks& links) {
  std::string out;
  for (const auto& [paper, all] : papers)
    for (const auto& [key, s] : all)
      if (is_study(key))
        out += fmt::format("{}[{}]({}/{}.md) {}",
                           out.empty() ? "" : "; ",
                           markdown(key.first.substr(key.first.find('/') + 1)),
                           links.pages,
                           folder_of(key.first),
                           words_of(s.claim.verdict, s.claim.origin));
  if (out.empty()) return "";
  return "\nStudies, whether numbers come out whatever is chosen where the "
         "paper "
         "prints no choice: " +
         out + ".\n";
}

std::string audit_link(const std::vector<NamedDigest>& campaigns,
                       const ResultsLinks& links) {
  if (audit_markdown(campaigns, links).empty()) return "";
  return fmt::format("What earlier judgements said: [audit]({}/{}).\n",
                     links.pages,
                     kAuditPage);
}

}  // namespace

std::string results_markdown(const std::vector<NamedDigest>& campaigns,
                             const ResultsLinks& links) {
  std::string out = fmt::format(
      "# Results\n\n{} from the campaigns under `reports/campaigns`; nothing "
      "here is copied by hand. A claim is the paper's (its sentence, number or "
      "figure) or a range of the suite, which earlier runs of this code or of "
      "independent programs showed. Only the former count as reproduced or "
      "not. Verdicts are today's, on the numbers that the campaigns kept; the "
      "newest campaign that decided counts, unless an older one ran more "
      "cases for it. `differs`: stronger or weaker than "
      "printed, the same direction; `depends`: on a choice that the paper does "
      "not print; `contradiction`: within the paper. Asked and measured is the "
      "first condition that does not hold, or the first one; a claim's page "
      "has all.\n\n",
      kWrittenByResults);
  try {
    const auto papers = latest_claims(campaigns);
    out += overview(papers);
    std::string ranges;
    for (const auto& [paper, all] : papers) {
      const std::string rows = rows_of(all, Origin::paper, {}, links);
      if (!rows.empty())
        out += fmt::format("\n## {}\n\n{} {}{}{}",
                           paper.empty() ? "(none)" : markdown(paper),
                           markdown(publication(paper, campaigns)),
                           spent(paper, campaigns),
                           kHead,
                           rows);
      ranges +=
          rows_of(all,
                  Origin::suite,
                  {Verdict::reproduced, Verdict::not_judged, Verdict::reported},
                  links);
    }
    if (!ranges.empty())
      out += fmt::format(
          "\n## Ranges of the suite that fail\n{}{}", kHead, ranges);
    return out + studies_line(papers, links) + others(campaigns, links) +
           audit_link(campaigns, links);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string("no digest of a campaign: ") +
                             error.what());
  }
}

}  // namespace physinv
