#include <fmt/format.h>

#include "reports/anchors.h"
#include "reports/html_parts.h"
#include "reports/report.h"

namespace physinv {
namespace {

std::string link(const std::string& id, const std::string& words) {
  return fmt::format("<a href=\"#{}\">{}</a>", id, html(words));
}

/// The paper's claims are what counts as reproduced; regression checks
/// are a line below.
std::string totals_html(const std::vector<Section>& sections) {
  int unmet = 0;
  for (const Section& s : sections)
    for (const ClaimResult& c : s.claims)
      unmet += c.gates && c.verdict == Verdict::not_reproduced;
  const Tally papers = tally(sections, Origin::paper);
  std::string out =
      "<p>What the papers say, by their sentences, tables and figures:</p>\n"
      "<ul class=\"totals\">\n";
  for (const Verdict v : columns_of(papers)) {
    const int count = papers[static_cast<std::size_t>(v)];
    out += fmt::format("<li class=\"{}\"><strong>{}</strong> {}</li>\n",
                       count == 0 ? "open" : css_of(v),
                       count,
                       words_of(v));
  }
  return out +
         fmt::format(
             "</ul>\n<p>Regression checks (ranges from earlier runs): "
             "{}. {}</p>\n",
             tally_text(tally(sections, Origin::suite)),
             unmet == 0
                 ? "All gating claims (marked •) that were judged are met."
                 : fmt::format("Gating claims (marked •) that are not "
                               "met: {}.",
                               unmet));
}

std::string chips_html(const Section& section,
                       const Anchors& anchors,
                       Origin origin) {
  std::string out;
  for (std::size_t k = 0; k < section.claims.size(); ++k) {
    const ClaimResult& c = section.claims[k];
    if (c.origin != origin) continue;
    out += fmt::format(
        "{}<a class=\"chip {}\" href=\"#{}\" title=\"{}: {}\">{} {}{}</a>",
        out.empty() ? "" : " ",
        css_of(c.verdict),
        anchors.claims[k],
        words_of(c.verdict),
        html(c.says),
        mark_of(c.verdict),
        html(c.id),
        c.gates ? " •" : "");
  }
  return out;
}

}  // namespace

std::string overview_html(const std::vector<Section>& sections,
                          const std::vector<Anchors>& anchors) {
  std::string out = totals_html(sections) +
                    "<div class=\"scroll\">\n<table class=\"overview\">\n"
                    "<caption class=\"hidden\">Claims by experiment</caption>\n"
                    "<thead>\n<tr><th scope=\"col\">experiment</th>";
  const auto columns = columns_of(tally(sections, Origin::paper));
  for (const Verdict v : columns) {
    out += fmt::format("<th scope=\"col\">{}</th>", words_of(v));
  }
  out +=
      "<th scope=\"col\">the paper's claims</th>"
      "<th scope=\"col\">regression checks</th></tr>\n</thead>\n<tbody>\n";
  for (std::size_t s = 0; s < sections.size(); ++s) {
    out += fmt::format("<tr><th scope=\"row\">{}</th>",
                       link(anchors[s].section, sections[s].title));
    const Tally counts = tally(sections[s], Origin::paper);
    for (const Verdict v : columns) {
      out += fmt::format("<td>{}<span class=\"word\"> {}</span></td>",
                         counts[static_cast<std::size_t>(v)],
                         words_of(v));
    }
    for (const Origin origin : {Origin::paper, Origin::suite})
      out += fmt::format("<td class=\"chips\">{}</td>",
                         chips_html(sections[s], anchors[s], origin));
    out += "</tr>\n";
  }
  return out + "</tbody>\n</table>\n</div>\n";
}

std::string contents_html(const std::vector<Section>& sections,
                          const std::vector<Anchors>& anchors) {
  std::string out =
      "<nav id=\"contents\" aria-label=\"Contents\">\n"
      "<p>" +
      link("top", "Overview") + "</p>\n";
  for (std::size_t k = 0; k < sections.size(); ++k) {
    const Section& s = sections[k];
    const Anchors& a = anchors[k];
    out += fmt::format("<details>\n<summary>{}</summary>\n<ul>\n<li>{}</li>\n",
                       html(s.title),
                       link(a.section, "Top"));
    for (const std::size_t i : order_of(s.figures))
      out += fmt::format(
          "<li>{}</li>\n",
          link(a.figures[i], name_of(s.figures[i].where, s.figures[i].title)));
    if (!s.claims.empty())
      out += fmt::format("<li>{}</li>\n", link(a.statements, "Statements"));
    for (std::size_t i = 0; i < s.tables.size(); ++i)
      out += fmt::format(
          "<li>{}</li>\n",
          link(a.tables[i], name_of(s.tables[i].where, s.tables[i].title)));
    out += "</ul>\n</details>\n";
  }
  return out + "<p>" + link("provenance", "Provenance") + "</p>\n</nav>\n";
}

}  // namespace physinv
