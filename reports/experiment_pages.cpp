#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "reports/digest.h"
#include "reports/digest_tables.h"
#include "reports/joined_tables.h"
#include "reports/latest_claims.h"
#include "reports/report.h"
#include "reports/results_page.h"
#include "reports/tables.h"
#include "reports/work.h"
#include "suite/results/markdown.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

/// Claims with all that was measured, the failing ones as they are.
std::string claims_of(const LatestClaims& all,
                      const std::string& experiment,
                      Origin origin) {
  std::string rows;
  for (const auto& [key, s] : all) {
    const ClaimResult& c = s.claim;
    if (key.first != experiment || c.origin != origin) continue;
    const std::string cause = cause_text(c.verdict, c.cause);
    rows += fmt::format("| {} | {}{} | {} | {}{}{} | {} |\n",
                        markdown(c.id),
                        markdown(c.says),
                        c.where.empty() ? "" : " (" + markdown(c.where) + ")",
                        words_of(c.verdict),
                        markdown(c.evidence),
                        cause.empty() ? "" : " **" + markdown(cause) + "**",
                        c.note.empty() ? "" : " *" + markdown(c.note) + "*",
                        markdown(s.campaign));
  }
  if (rows.empty()) return "";
  return fmt::format(
      "\n## {}\n\n| id | claim | verdict | measured | campaign |\n"
      "| --- | --- | --- | --- | --- |\n{}",
      origin == Origin::paper ? "What the paper says"
                              : "Ranges of the suite (regression checks)",
      rows);
}

/// A path as the target of a link: what could end it is written by its code.
std::string target(std::string_view path) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./";
  std::string out;
  for (const char c : path)
    out += kPlain.find(c) != kPlain.npos
               ? std::string(1, c)
               : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return out;
}

std::string figures_of(const Json& section,
                       const std::string& campaign,
                       const ResultsLinks& links) {
  std::string out;
  for (const Json& figure : section.value("figures", Json::array())) {
    out += fmt::format("\n![{}]({}/{}/figures/{})\n",
                       markdown(text_of(figure, "title")),
                       target(links.campaigns),
                       target(campaign),
                       target(text_of(figure, "file")));
    const std::string note = text_of(figure, "note");
    if (!note.empty()) out += '\n' + markdown(note) + '\n';
  }
  return out;
}

/// What the campaign kept and, of a paper's own section, the tables that its
/// experiments share, unless they were kept.
std::vector<Table> tables_of(const Json& section, const Json& digest) {
  std::vector<Table> tables;
  for (const Json& table : section.at("tables"))
    tables.push_back(table_from(table));
  const std::string paper = section.at("paper");
  if (section.at("experiment").get<std::string>() != paper) return tables;
  const auto kept = tables;
  for (Table& joined : joined_tables(sections_of(digest), paper))
    if (std::ranges::none_of(kept, [&](const Table& t) {
          return t.where == joined.where && t.title == joined.title;
        }))
      tables.push_back(std::move(joined));
  return tables;
}

std::string campaign_of(const NamedDigest& campaign,
                        const Json& section,
                        const std::vector<Table>& tables,
                        const ResultsLinks& links) {
  const Json& p = campaign.digest.at("provenance");
  const auto word = [&](const char* key, std::size_t most = std::string::npos) {
    return markdown(text_of(p, key).substr(0, most));
  };
  std::string out = fmt::format(
      "\n## Campaign {}\n\n{}\n\n{}, {} ({} cores), {}, {} {}, revision {}",
      markdown(campaign.name),
      markdown_code(campaign_command(campaign.name)),
      word("date", 10),
      word("cpu_model"),
      word("num_cpus"),
      word("instruction_set"),
      word("compiler"),
      word("compiler_flags"),
      word("git_revision", 12));
  const auto cpu =
      campaign.cpu_seconds.find(section.at("experiment").get<std::string>());
  if (cpu != campaign.cpu_seconds.end())
    out += fmt::format(", {:.0f} s of CPU", cpu->second);
  out += '\n';
  const auto work =
      campaign.work.find(section.at("experiment").get<std::string>());
  if (work != campaign.work.end())
    if (const std::string text =
            work_text(work->second, markdown, markdown_code);
        !text.empty())
      out += '\n' + text + '\n';
  for (const Table& table : tables) out += '\n' + to_markdown(table);
  return out + figures_of(section, campaign.name, links);
}

std::string page_of(const std::string& experiment,
                    const std::vector<NamedDigest>& campaigns,
                    const Papers& papers,
                    const ResultsLinks& links) {
  std::string title, body;
  for (const NamedDigest& c : campaigns)
    for (const Json& section : c.digest.at("sections")) {
      if (section.at("experiment") != experiment) continue;
      if (title.empty()) title = text_of(section, "title");
      const auto tables = tables_of(section, c.digest);
      if (!tables.empty() || section.contains("figures"))
        body += campaign_of(c, section, tables, links);
    }
  std::string out = fmt::format(
      "# {} ({})\n\n{} from `reports/campaigns`; "
      "back to [all results]({}).\n",
      markdown(title),
      markdown_code(experiment),
      kWrittenByResults,
      target(links.overview));
  for (const Origin origin : {Origin::paper, Origin::suite})
    for (const auto& [paper, all] : papers)
      out += claims_of(all, experiment, origin);
  return out + body;
}

}  // namespace

std::map<std::string, std::string> experiment_pages(
    const std::vector<NamedDigest>& campaigns, const ResultsLinks& links) {
  try {
    const auto papers = latest_claims(campaigns);
    const auto ordered = newest_first(campaigns);
    std::set<std::string> experiments;
    for (const NamedDigest& c : ordered)
      for (const Json& section : c.digest.at("sections"))
        experiments.insert(section.at("experiment").get<std::string>());
    std::map<std::string, std::string> pages;
    for (const std::string& e : experiments)
      pages[folder_of(e) + ".md"] = page_of(e, ordered, papers, links);
    return pages;
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string("not a digest of a campaign: ") +
                             error.what());
  }
}

}  // namespace physinv
