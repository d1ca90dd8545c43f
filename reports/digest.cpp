#include "reports/digest.h"

#include <fmt/format.h>

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

/// Verdicts of the claims, one for each experiment and id.
using Verdicts = std::map<std::pair<std::string, std::string>, Verdict>;

struct Counted {
  std::string title;
  Verdicts paper, suite;
};

/// What was decided counts before what was only reported.
int weight(Verdict verdict) {
  return verdict == Verdict::not_judged ? 0
         : verdict == Verdict::reported ? 1
                                        : 2;
}

Origin origin_of(const Json& claim) {
  return claim.at("origin") == "paper" ? Origin::paper : Origin::suite;
}

/// That a claim of a digest came to.
Verdict verdict_in(const Json& claim) {
  const std::string words = claim.at("verdict");
  const auto verdict = verdict_of(words);
  if (!verdict)
    throw std::runtime_error(
        fmt::format("no digest of a campaign: '{}' is no verdict", words));
  return *verdict;
}

void count(const Json& section, std::map<std::string, Counted>& papers) {
  const std::string experiment = section.at("experiment");
  for (const Json& claim : section.at("claims")) {
    Counted& counted = papers[section.at("paper").get<std::string>()];
    auto& verdicts =
        origin_of(claim) == Origin::paper ? counted.paper : counted.suite;
    const Verdict verdict = verdict_in(claim);
    const auto [entry, first] = verdicts.try_emplace(
        {experiment, claim.at("id").get<std::string>()}, verdict);
    if (!first && weight(verdict) >= weight(entry->second))
      entry->second = verdict;
  }
}

int count_of(const Verdicts& verdicts, Verdict verdict) {
  int count = 0;
  for (const auto& [id, v] : verdicts) count += v == verdict;
  return count;
}

std::string overview(const std::vector<NamedDigest>& campaigns) {
  std::map<std::string, Counted> papers;
  for (const auto& c : campaigns)
    for (const Json& section : c.digest.at("sections")) count(section, papers);
  std::string out = "| paper |", line = "\n| --- |";
  for (const Origin origin : {Origin::paper, Origin::suite})
    for (const Verdict v : kVerdicts) {
      const bool first_range = origin == Origin::suite && v == kVerdicts[0];
      out += fmt::format(" {}{} |",
                         first_range ? "ranges of the suite: " : "",
                         words_of(v, origin));
      line += " --- |";
    }
  out += line + '\n';
  for (const auto& [paper, c] : papers) {
    out += fmt::format("| {} |", paper.empty() ? "(none)" : markdown(paper));
    for (const Verdicts* verdicts : {&c.paper, &c.suite})
      for (const Verdict v : kVerdicts)
        out += fmt::format(" {} |", count_of(*verdicts, v));
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

/// Judged claims with their numbers, then the others by what is missing.
std::string claims_of(const Json& section, const char* origin) {
  std::string rows;
  std::map<std::string, std::string> waiting;  // what for -> ids
  for (const Json& claim : section.at("claims")) {
    if (claim.at("origin") != origin) continue;
    const std::string where = text_of(claim, "where");
    const std::string note = text_of(claim, "note");
    const std::string evidence = text_of(claim, "evidence");
    if (verdict_in(claim) == Verdict::not_judged) {
      std::string& ids = waiting[evidence.empty() ? note : evidence];
      ids += (ids.empty() ? "" : ", ") + text_of(claim, "id");
      continue;
    }
    rows += fmt::format("| {} | {}{} | {} | {}{} |\n",
                        markdown(text_of(claim, "id")),
                        markdown(text_of(claim, "says")),
                        where.empty() ? "" : " (" + markdown(where) + ")",
                        words_of(verdict_in(claim), origin_of(claim)),
                        markdown(evidence),
                        note.empty() ? "" : " *" + markdown(note) + "*");
  }
  if (rows.empty() && waiting.empty()) return "";
  const bool paper = std::string_view(origin) == "paper";
  std::string out = paper ? "\nWhat the paper says:\n"
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
    for (const char* origin : {"paper", "suite"})
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
      "Only the former count as reproduced or not.\n\n";
  try {
    out += overview(campaigns);
    for (const auto& c : campaigns) out += campaign_markdown(c);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string("no digest of a campaign: ") +
                             error.what());
  }
  return out;
}

}  // namespace physinv
