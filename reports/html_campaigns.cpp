#include <fmt/format.h>

#include "reports/html.h"
#include "reports/html_parts.h"

namespace physinv {
namespace {

std::string campaign_html(const CampaignPages& campaign) {
  std::string titles;
  for (const Section& s : campaign.sections)
    titles += (titles.empty() ? "" : ", ") + html(s.title);
  std::string out = fmt::format(
      "<article>\n<h3><a href=\"{0}/index.html\">{0}</a></h3>\n{1}"
      "<p class=\"remark\">{2}</p>\n",
      html(campaign.name),
      summary_html(campaign.provenance),
      titles);
  const std::string papers =
      verdicts_html(tally(campaign.sections, Origin::paper));
  const std::string ranges =
      verdicts_html(tally(campaign.sections, Origin::suite));
  if (!papers.empty()) out += "<p>The papers: " + papers + "</p>\n";
  if (!ranges.empty())
    out += "<p class=\"remark\">Regression checks: " + ranges + "</p>\n";
  return out + "<p class=\"remark data\"><code>" + html(campaign.command) +
         "</code></p>\n</article>\n";
}

}  // namespace

std::string campaigns_html(
    const std::vector<CampaignPages>& campaigns,
    const std::vector<std::pair<std::string, std::string>>& others) {
  PageParts parts{.title = "Physics inverse problems: published campaigns"};
  parts.header =
      "<h1>Physics inverse problems: published campaigns</h1>\n"
      "<p>Statements, tables and published figures of each campaign that is "
      "stored with the sources. Statements are judged by their current "
      "definitions. The command below a campaign runs it again.</p>\n";
  for (const auto& [folder, title] : others)
    parts.header += fmt::format(
        "<p><a href=\"{}/index.html\">{}</a></p>\n", html(folder), html(title));
  parts.main = "<section id=\"campaigns\">\n";
  for (const CampaignPages& c : campaigns) {
    CampaignPages brief{c.name, c.command, c.provenance, c.sections};
    if (brief.provenance.is_object()) brief.provenance.erase("papers");
    parts.main += campaign_html(brief);
  }
  parts.main += "</section>\n";
  return page_html(parts);
}

}  // namespace physinv
