// What earlier judgements said, and what all campaigns took.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "reports/latest_claims.h"
#include "reports/results_page.h"
#include "suite/results/markdown.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kHour = 3600;

/// What the campaigns said when claims had no causes.
std::vector<NamedDigest> without_causes(
    const std::vector<NamedDigest>& campaigns) {
  std::vector<NamedDigest> all;
  for (const NamedDigest& c : campaigns) {
    if (c.published.is_null()) continue;
    Json old = c.published;
    for (Json& section : old.at("sections")) {
      Json claims = Json::array();
      for (const Json& claim : section.at("claims"))
        if (!claim.contains("cause")) claims.push_back(claim);
      section["claims"] = std::move(claims);
    }
    all.push_back({c.name, std::move(old)});
  }
  return all;
}

/// CPU-hours of solving by paper, machine and revision, and of a paper in all.
std::string hours_table(const std::vector<NamedDigest>& campaigns) {
  struct Spent {
    std::set<std::string> campaigns;
    double seconds = 0;
  };
  std::map<std::string, std::map<std::vector<std::string>, Spent>> papers;
  for (const NamedDigest& c : campaigns)
    for (const auto& [experiment, cpu] : c.cpu_seconds) {
      const Json& p = c.digest.at("provenance");
      const std::vector<std::string> key{
          text_of(p, "cpu_model"), text_of(p, "git_revision").substr(0, 8)};
      const std::string paper = experiment.substr(0, experiment.find('/'));
      Spent& one = papers[paper][key];
      one.campaigns.insert(c.name), one.seconds += cpu;
    }
  if (papers.empty()) return "";
  std::string out =
      "\n## CPU-hours of solving\n\n"
      "| experiments of | machine | revision | campaigns | CPU-hours |\n"
      "| --- | --- | --- | --- | ---: |\n";
  for (const auto& [paper, all] : papers) {
    double sum = 0;
    for (const auto& [key, one] : all) {
      sum += one.seconds;
      out += fmt::format(
          "| {} | {} | {} | {} | {:.2f} |\n",
          markdown(paper),
          markdown(key[0]),
          markdown(key[1]),
          markdown(fmt::format("{}", fmt::join(one.campaigns, ", "))),
          one.seconds / kHour);
    }
    out += fmt::format(
        "| {} | all |  |  | {:.2f} |\n", markdown(paper), sum / kHour);
  }
  return out;
}

/// The campaign and how many runs stand behind what it decided.
std::string decided_by(const LatestClaim& s) {
  std::int64_t runs = 0;
  for (const ConditionResult& c : s.claim.conditions)
    runs = std::max(runs, std::int64_t{c.runs});
  if (runs == 0) return s.campaign;
  return fmt::format("{}, {} run{}", s.campaign, runs, runs == 1 ? "" : "s");
}

constexpr std::array kWhen{"then", "now"};
using AuditCounts = std::array<VerdictCounts, kWhen.size()>;

/// How many came to which verdict, then and now.
std::string audit_counts(const AuditCounts& counts) {
  VerdictCounts any{};
  for (const VerdictCounts& c : counts)
    for (std::size_t v = 0; v < any.size(); ++v) any[v] += c[v];
  std::string out = "| |", line = "\n| --- |";
  for (const Verdict v : columns_of(any)) {
    out += fmt::format(" {} |", words_of(v, Origin::paper));
    line += " ---: |";
  }
  out += line + '\n';
  for (std::size_t k = 0; k < counts.size(); ++k) {
    out += fmt::format("| {} |", kWhen[k]);
    for (const Verdict v : columns_of(any))
      out += fmt::format(" {} |", counts[k][static_cast<std::size_t>(v)]);
    out += '\n';
  }
  return out;
}

}  // namespace

std::string audit_markdown(const std::vector<NamedDigest>& campaigns,
                           const ResultsLinks& links) {
  try {
    const Papers then = latest_claims(without_causes(campaigns));
    const Papers now = latest_claims(campaigns);
    std::string rows;
    AuditCounts counts{};
    for (const auto& [paper, all] : then)
      for (const auto& [key, old] : all) {
        if (old.claim.origin != Origin::paper) continue;
        const LatestClaim& own = now.at(paper).at(key);
        const Verdict was = old.claim.verdict, is = own.claim.verdict;
        ++counts[0][static_cast<std::size_t>(was)];
        ++counts[1][static_cast<std::size_t>(is)];
        rows += fmt::format("| [{}]({}.md) {} | {} | {} | {} | {} |\n",
                            markdown(key.first),
                            folder_of(key.first),
                            markdown(key.second),
                            words_of(was, Origin::paper),
                            words_of(is, Origin::paper),
                            markdown(own.claim.cause),
                            markdown(decided_by(own)));
      }
    if (rows.empty()) return "";
    return fmt::format(
        "# Verdicts before claims had causes\n\n{} from "
        "`reports/campaigns`; back to [all results]({}). What these campaigns "
        "said of the papers' claims when they were published, and what they "
        "and later ones come to by what is registered now.\n\n{}\n"
        "Of the runs behind a verdict, those of the condition that has the "
        "most.\n\n"
        "| claim | verdict then | verdict now | cause | decided by |\n"
        "| --- | --- | --- | --- | --- |\n{}{}",
        kWrittenByResults,
        links.overview,
        audit_counts(counts),
        rows,
        hours_table(campaigns));
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string("no digest of a campaign: ") +
                             error.what());
  }
}

}  // namespace physinv
