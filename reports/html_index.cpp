#include <fmt/format.h>

#include <algorithm>

#include "reports/anchors.h"
#include "reports/html.h"
#include "reports/html_parts.h"
#include "reports/key_figure.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

std::string key_of(const Section& section) {
  return section.experiment.substr(0, section.experiment.find('/'));
}

/// The cards of a paper, those with a picture first.
std::string cards_html(const Part& part, const Pages& pages) {
  std::string out = fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-title\">\n"
      "<h2 id=\"{0}-title\">{1}</h2>\n",
      html(part.group.key),
      html(part.group.title));
  if (!part.group.text.empty())
    out += fmt::format(
        "<p class=\"remark\">{}{}</p>\n",
        html(part.group.text),
        part.group.link.empty()
            ? ""
            : fmt::format(" <a href=\"{0}\">{0}</a>", html(part.group.link)));
  std::string with, without;
  for (const Section* section : part.sections) {
    const auto picture = card_text(*section, pictures_of(pages, *section));
    (picture ? with : without) +=
        card_html(*section, folder_of(section->experiment), picture);
  }
  return out + "<div class=\"cards\">\n" + with + without +
         "</div>\n</section>\n";
}

/// The groups asked for, then one for each key that none of them has.
std::vector<Group> all_groups(std::vector<Group> groups,
                              const std::vector<Section>& sections) {
  for (const Section& s : sections) {
    const std::string key = key_of(s);
    if (std::none_of(groups.begin(), groups.end(), [&](const Group& g) {
          return g.key == key;
        }))
      groups.push_back({.key = key, .title = key, .text = {}, .link = {}});
  }
  return groups;
}

std::vector<Part> parts_of(const std::vector<Group>& groups,
                           const std::vector<Section>& sections) {
  std::vector<Part> parts;
  for (const Group& group : groups) {
    Part part{group, {}};
    for (const Section& section : sections)
      if (key_of(section) == group.key) part.sections.push_back(&section);
    if (!part.sections.empty()) parts.push_back(std::move(part));
  }
  return parts;
}

std::string contents_html(const std::vector<Part>& parts,
                          const std::string& chapters) {
  std::string out = "<nav id=\"contents\" aria-label=\"Contents\">\n";
  for (const Part& part : parts) {
    out += fmt::format("<details>\n<summary>{}</summary>\n<ul>\n",
                       html(part.group.key));
    for (const Section* section : part.sections)
      out += fmt::format("<li><a href=\"{}/index.html\">{}</a></li>\n",
                         html(folder_of(section->experiment)),
                         html(section->title));
    out += "</ul>\n</details>\n";
  }
  for (const auto& [id, words] :
       {std::pair("deviations", kDeviations), std::pair("numbers", kMeasured)})
    if (chapters.find(fmt::format("<section id=\"{}\"", id)) != out.npos)
      out += fmt::format("<p><a href=\"#{}\">{}</a></p>\n", id, words);
  return out + "<p><a href=\"#provenance\">Provenance</a></p>\n</nav>\n";
}

/// Verdicts that occur.
std::string tallies_html(const std::vector<Section>& sections) {
  std::string out;
  const auto add = [&](const char* format, Origin origin) {
    const auto counts = counts_html(tally(sections, origin));
    if (!counts.empty()) out += fmt::format(fmt::runtime(format), counts);
  };
  add("<p>Statements of the papers: {}.</p>\n", Origin::paper);
  add("<p class=\"remark\">Regression checks of this suite: {}.</p>\n",
      Origin::suite);
  return out;
}

}  // namespace

std::string index_html(const std::vector<Section>& sections,
                       const Pages& pages,
                       const nlohmann::ordered_json& provenance) {
  const auto front = sections.begin() + static_cast<std::ptrdiff_t>(std::min(
                                            pages.front, sections.size()));
  const std::vector<Section> whole(sections.begin(), front),
      others(front, sections.end());
  const auto all = parts_of(all_groups(pages.groups, others), others);
  const std::string chapters = chapters_html(all);
  PageParts parts{.title = "Physics inverse problems: report",
                  .header = {},
                  .contents = contents_html(all, chapters),
                  .main = {},
                  .footer = {},
                  .pictures = true};
  nlohmann::ordered_json brief = provenance;
  if (brief.is_object()) brief.erase("papers");  // the groups name them
  parts.header = "<h1>" + html(heading_of(provenance)) + "</h1>\n" +
                 summary_html(brief) + tallies_html(sections);
  const auto anchors = anchors_of(whole);
  const Palette palette(sections);
  for (std::size_t k = 0; k < whole.size(); ++k)
    parts.main += section_html(whole[k],
                               anchors[k],
                               palette,
                               {.folder = folder_of(whole[k].experiment)});
  for (const Part& part : all) parts.main += cards_html(part, pages);
  parts.main += chapters;
  parts.footer = provenance_html(brief);
  return page_html(parts);
}

}  // namespace physinv
