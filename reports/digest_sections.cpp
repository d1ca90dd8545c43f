#include <fmt/format.h>

#include <vector>

#include "reports/digest.h"
#include "reports/digest_tables.h"
#include "reports/report.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

Section section_of(const Json& digest) {
  Section section{.experiment = digest.at("experiment"),
                  .title = digest.at("title"),
                  .paper = digest.at("paper")};
  section.standing = digest.value("standing", "");
  for (const Json& claim : digest.at("claims"))
    section.claims.push_back(claim_from(claim));
  for (const Json& table : digest.at("tables")) {
    section.tables.push_back(table_from(table));
    section.tables.back().id = fmt::format("table-{}", section.tables.size());
  }
  return section;
}

}  // namespace

std::vector<Section> sections_of(const Json& digest) {
  std::vector<Section> sections;
  for (const Json& section : digest.at("sections"))
    sections.push_back(section_of(section));
  return sections;
}

std::vector<Section> sections_of(const NamedDigest& campaign) {
  std::vector<Section> sections = sections_of(campaign.digest);
  for (Section& s : sections)
    if (const auto at = campaign.work.find(s.experiment);
        at != campaign.work.end())
      s.work = at->second;
  return sections;
}

}  // namespace physinv
