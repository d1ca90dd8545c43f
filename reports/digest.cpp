#include "reports/digest.h"

#include <fmt/format.h>

#include "reports/digest_tables.h"
#include "reports/plot.h"
#include "reports/report.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

/// The papers' figures. A film is a file of its own size.
bool is_kept(const Figure& f) { return !f.where.empty() && f.moment == 0; }

std::string file_of(const Section& section, const Figure& figure) {
  return fmt::format("{}-{}.svg", folder_of(section.experiment), figure.id);
}

Json figures_json(const Section& section) {
  Json out = Json::array();
  for (const Figure& f : section.figures)
    if (is_kept(f))
      out.push_back(
          {{"file", file_of(section, f)},
           {"title", f.where.empty() ? f.title : f.where + " · " + f.title},
           {"note", f.note}});
  return out;
}

}  // namespace

Json digest_json(const std::vector<Section>& sections, const Json& provenance) {
  Json out{{"schema_version", kClaimsVersion},
           {"provenance", provenance},
           {"sections", Json::array()}};
  for (const Section& s : sections) {
    Json claims = Json::array(), tables = Json::array();
    for (const ClaimResult& c : s.claims) claims.push_back(to_json(c));
    for (const Table& t : s.tables) tables.push_back(table_json(t));
    out["sections"].push_back({{"experiment", s.experiment},
                               {"title", s.title},
                               {"paper", s.paper},
                               {"standing", s.standing},
                               {"claims", std::move(claims)},
                               {"tables", std::move(tables)},
                               {"figures", figures_json(s)}});
  }
  return out;
}

std::map<std::string, std::string> kept_figures(
    const std::vector<Section>& sections) {
  const Palette palette(sections);
  std::map<std::string, std::string> files;
  for (const Section& s : sections)
    for (const Figure& f : s.figures)
      if (is_kept(f)) files[file_of(s, f)] = render_svg(f, palette);
  return files;
}

std::string campaign_command(const std::string& name) {
  return "./bench reproduce " + name;
}

}  // namespace physinv
