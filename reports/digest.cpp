#include "reports/digest.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "reports/report.h"
#include "reports/tables.h"
#include "suite/results/markdown.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return "";
  return found->is_string() ? found->get<std::string>() : found->dump();
}

/// What the campaigns came to about one claim.
struct Standing {
  ClaimResult claim;
  std::string campaign;
};
/// One for each experiment and id.
using Standings = std::map<std::pair<std::string, std::string>, Standing>;
using Papers = std::map<std::string, Standings>;

/// What was decided counts before what was judged in part, and that before what
/// was only reported.
int weight(Verdict verdict) {
  switch (verdict) {
    case Verdict::not_judged:
      return 0;
    case Verdict::reported:
      return 1;
    case Verdict::partly_judged:
      return 2;
    default:
      return 3;
  }
}

std::string date_of(const NamedDigest& campaign) {
  return text_of(campaign.digest.at("provenance"), "date");
}

/// Whatever the campaigns are called, a later one counts before an earlier one.
Papers standings(std::vector<NamedDigest> campaigns) {
  std::stable_sort(
      campaigns.begin(), campaigns.end(), [](const auto& a, const auto& b) {
        return date_of(a) < date_of(b);
      });
  Papers papers;
  for (const NamedDigest& c : campaigns)
    for (const Json& section : c.digest.at("sections"))
      for (const Json& claim : section.at("claims")) {
        Standing found{claim_from(claim), c.name};
        const auto [entry, first] =
            papers[section.at("paper").get<std::string>()].try_emplace(
                {section.at("experiment").get<std::string>(), found.claim.id},
                found);
        if (!first &&
            weight(found.claim.verdict) >= weight(entry->second.claim.verdict))
          entry->second = std::move(found);
      }
  return papers;
}

VerdictCounts counts_of(const Standings& paper, Origin origin) {
  VerdictCounts counts{};
  for (const auto& [id, s] : paper)
    if (s.claim.origin == origin)
      ++counts[static_cast<std::size_t>(s.claim.verdict)];
  return counts;
}

std::string overview(const Papers& papers,
                     const std::vector<NamedDigest>& campaigns) {
  std::array<VerdictCounts, 2> totals{};
  constexpr std::array kOrigins{Origin::paper, Origin::suite};
  for (const auto& [paper, standings] : papers)
    for (std::size_t o = 0; o < kOrigins.size(); ++o)
      for (const Verdict v : kVerdicts)
        totals[o][static_cast<std::size_t>(v)] +=
            counts_of(standings, kOrigins[o])[static_cast<std::size_t>(v)];
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
  std::set<std::string> publications;
  for (const auto& c : campaigns)
    for (const Json& paper :
         c.digest.at("provenance").value("papers", Json::array()))
      publications.insert(paper.get<std::string>());
  out += '\n';
  for (const auto& text : publications) out += "- " + markdown(text) + '\n';
  return out;
}

/// Every claim that is not reproduced, once, with its cause: what fails first.
std::string causes(const Papers& papers) {
  constexpr std::array kOrder{Verdict::not_reproduced,
                              Verdict::contradiction,
                              Verdict::depends,
                              Verdict::differs,
                              Verdict::partly_judged,
                              Verdict::not_judged,
                              Verdict::reported};
  static_assert(kOrder.size() + 1 == kVerdictCount);
  std::string rows;
  for (const auto& [paper, standings] : papers)
    for (const Verdict v : kOrder)
      for (const auto& [key, s] : standings)
        if (s.claim.verdict == v)
          rows += fmt::format(
              "| {} {} | {} | {} | {} | {} |\n",
              markdown(key.first),
              markdown(key.second),
              markdown(s.claim.says),
              words_of(v, s.claim.origin),
              markdown(s.claim.cause.empty() ? "unknown" : s.claim.cause),
              markdown(s.campaign));
  if (rows.empty()) return "";
  return "\n## What is not reproduced, and why\n\n"
         "The latest campaign that decided counts. `differs`: stronger or "
         "weaker than printed, the same direction; `depends`: on a choice that "
         "the paper does not print; `contradiction`: within the paper.\n\n"
         "| claim | says | verdict | cause | campaign |\n"
         "| --- | --- | --- | --- | --- |\n" +
         rows;
}

/// Judged claims with their numbers, then the others by what is missing.
std::string claims_of(const Json& section, Origin origin) {
  std::string rows;
  std::map<std::string, std::string> waiting;  // what for -> ids
  for (const Json& json : section.at("claims")) {
    const ClaimResult claim = claim_from(json);
    if (claim.origin != origin) continue;
    if (claim.verdict == Verdict::not_judged) {
      std::string& ids =
          waiting[claim.evidence.empty() ? claim.note : claim.evidence];
      ids += (ids.empty() ? "" : ", ") + claim.id;
      continue;
    }
    const std::string cause = cause_text(claim.verdict, claim.cause);
    rows += fmt::format(
        "| {} | {}{} | {} | {}{}{} |\n",
        markdown(claim.id),
        markdown(claim.says),
        claim.where.empty() ? "" : " (" + markdown(claim.where) + ")",
        words_of(claim.verdict, claim.origin),
        markdown(claim.evidence),
        cause.empty() ? "" : " **" + markdown(cause) + "**",
        claim.note.empty() ? "" : " *" + markdown(claim.note) + "*");
  }
  if (rows.empty() && waiting.empty()) return "";
  std::string out = origin == Origin::paper
                        ? "\nWhat the paper says:\n"
                        : "\nRanges of the suite (regression checks):\n";
  if (!rows.empty())
    out +=
        "\n| id | claim | verdict | measured |\n| --- | --- | --- | --- |\n" +
        rows;
  if (!waiting.empty()) out += "\nNot judged by this campaign:\n\n";
  for (const auto& [why, ids] : waiting)
    out += fmt::format("- {}: {}\n", markdown(ids), markdown(why));
  return out;
}

std::string campaign_markdown(const NamedDigest& campaign) {
  const Json& p = campaign.digest.at("provenance");
  const auto word = [&](const char* key, std::size_t most = std::string::npos) {
    return markdown(text_of(p, key).substr(0, most));
  };
  std::string out = fmt::format(
      "\n## Campaign {}\n\n{}\n\n{}, {} ({} cores), {}, {} {}, revision {}\n",
      markdown(campaign.name),
      markdown_code(campaign_command(p)),
      word("date", 10),
      word("cpu_model"),
      word("num_cpus"),
      word("instruction_set"),
      word("compiler"),
      word("compiler_flags"),
      word("git_revision", 12));
  for (const Json& section : campaign.digest.at("sections")) {
    out += fmt::format("\n### {} ({})\n",
                       markdown(text_of(section, "title")),
                       markdown_code(text_of(section, "experiment")));
    for (const Origin origin : {Origin::paper, Origin::suite})
      out += claims_of(section, origin);
    for (const Json& table : section.at("tables"))
      out += '\n' + table.get<std::string>();
  }
  return out;
}

}  // namespace

Json digest_json(const std::vector<Section>& sections, const Json& provenance) {
  Json out{{"provenance", provenance}, {"sections", Json::array()}};
  for (const Section& s : sections) {
    Json claims = Json::array(), tables = Json::array();
    for (const ClaimResult& c : s.claims) claims.push_back(to_json(c));
    for (const Table& t : s.tables) tables.push_back(to_markdown(t));
    out["sections"].push_back({{"experiment", s.experiment},
                               {"title", s.title},
                               {"paper", s.paper},
                               {"claims", std::move(claims)},
                               {"tables", std::move(tables)}});
  }
  return out;
}

std::string campaign_command(const Json& provenance) {
  std::string out = "./bench --profile=" + text_of(provenance, "profile");
  const auto options = provenance.find("options");
  if (options == provenance.end()) return out;
  for (const char* list : {"filter", "set"})
    if (options->contains(list))
      for (const Json& value : (*options)[list])
        out += fmt::format(" '--{}={}'", list, value.get<std::string>());
  const std::string seeds = text_of(*options, "seeds");
  if (!seeds.empty()) out += " --seeds=" + seeds;
  return out;
}

std::string results_markdown(const std::vector<NamedDigest>& campaigns) {
  std::string out =
      "# Results\n\n"
      "Written by `./bench results` from the campaigns under "
      "`reports/campaigns`; nothing here is copied by hand. A claim is the "
      "paper's (its sentence, number or figure) or a range of the suite, "
      "which earlier runs of this code or of independent programs showed. "
      "Only the former count as reproduced or not. Verdicts are today's, on "
      "the numbers that the campaigns kept.\n\n";
  try {
    const auto papers = standings(campaigns);
    out += overview(papers, campaigns) + causes(papers);
    for (const auto& c : campaigns) out += campaign_markdown(c);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string("no digest of a campaign: ") +
                             error.what());
  }
  return out;
}

}  // namespace physinv
