/// The report as HTML pages that need nothing but themselves: style, script and
/// figures are inside, and their policy forbids them to fetch anything.
/// Everything can be read without the script, which adds read-outs of points,
/// switching series by the legend, and the choice of light or dark.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "reports/report.h"
#include "suite/results/report_model.h"

namespace physinv {

/// All of it as one page. Same sections and provenance, same bytes. Ids of
/// claims, tables and figures are <experiment>-<id> with '-' for all but
/// letters and digits; a number follows where that would repeat.
std::string report_html(const std::vector<Section>& sections,
                        const nlohmann::ordered_json& provenance);

/// The index of the pages of experiments, <folder>/index.html: sections that
/// come first; of each paper a card per experiment with its key figure,
/// <folder>/card.svg, how its methods compare, and the verdicts; below all
/// cards the statements that do not hold as printed, with what was measured and
/// why, then numbers that papers print next to the measured ones.
std::string index_html(const std::vector<Section>& sections,
                       const Pages& pages,
                       const nlohmann::ordered_json& provenance);

/// A campaign whose pages are in the folder of its name.
struct CampaignPages {
  std::string name, command;
  nlohmann::ordered_json provenance;
  std::vector<Section> sections;
};
/// What leads to the pages of campaigns, and of other things: folder, title.
std::string campaigns_html(
    const std::vector<CampaignPages>& campaigns,
    const std::vector<std::pair<std::string, std::string>>& others);

}  // namespace physinv
