#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "reports/anchors.h"
#include "reports/html_parts.h"
#include "reports/work.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

std::string code_html(std::string_view text) {
  return "<code>" + html(text) + "</code>";
}

/// Links, with commas.
void add_link(std::string& links, const std::string& id, std::string words) {
  links += fmt::format(
      "{}<a href=\"#{}\">{}</a>", links.empty() ? "" : ", ", id, html(words));
}

/// The tables and figures of the place that a claim names.
std::string shown_in(const ClaimResult& claim,
                     const Section& section,
                     const Anchors& anchors) {
  std::string links;
  for (std::size_t k = 0; k < section.tables.size(); ++k)
    if (share_place(claim.where, section.tables[k].where))
      add_link(links, anchors.tables[k], section.tables[k].where);
  for (std::size_t k = 0; k < section.figures.size(); ++k)
    if (share_place(claim.where, section.figures[k].where))
      add_link(links, anchors.figures[k], section.figures[k].where);
  return links.empty() ? "" : " · here: " + links;
}

/// The claims about a table's or figure's place.
std::string said_of(std::string_view where,
                    const Section& section,
                    const Anchors& anchors) {
  std::string links;
  for (std::size_t k = 0; k < section.claims.size(); ++k) {
    const ClaimResult& c = section.claims[k];
    if (share_place(c.where, where))
      add_link(links,
               anchors.claims[k],
               fmt::format("{} {}", mark_of(c.verdict), c.id));
  }
  return links.empty() ? ""
                       : "<p class=\"remark\">Statements: " + links + "</p>\n";
}

std::string claim_html(const ClaimResult& claim,
                       const std::string& id,
                       const std::string& shown) {
  std::string out = fmt::format(
      "<tr id=\"{0}\"><th scope=\"row\"><a class=\"self\" href=\"#{0}\">{1}</a>"
      "</th><td class=\"verdict {2}\">{3} {4}</td><td><p>{5}</p>",
      id,
      html(claim.id),
      css_of(claim.verdict),
      mark_of(claim.verdict),
      words_of(claim.verdict),
      html(claim.says));
  if (!claim.evidence.empty()) {
    out += fmt::format("<p class=\"evidence\">{}</p>", html(claim.evidence));
  }
  const std::string cause = cause_text(claim.verdict, claim.cause);
  if (!cause.empty())
    out += fmt::format("<p class=\"cause\">{}</p>", html(cause));
  if (!claim.note.empty())
    out += fmt::format("<p class=\"evidence\">{}</p>", html(claim.note));
  return out + fmt::format("<p class=\"evidence\">{}{}{}{}</p></td></tr>\n",
                           claim.where.empty() ? "" : html(claim.where) + " · ",
                           claim.gates ? "• gating" : "not gating",
                           claim.from.empty()
                               ? ""
                               : fmt::format(", judged from profile {}",
                                             html(claim.from)),
                           shown);
}

std::string claims_table_html(const std::string& title,
                              const Section& section,
                              const std::string& rows) {
  return fmt::format(
             "<div class=\"scroll\">\n<table class=\"claims\">\n"
             "<caption class=\"hidden\">{}: {}</caption>\n",
             title,
             html(section.title)) +
         "<thead class=\"hidden\">\n<tr><th scope=\"col\">id</th>"
         "<th scope=\"col\">verdict</th><th scope=\"col\">claim and "
         "evidence</th></tr>\n</thead>\n<tbody>\n" +
         rows + "</tbody>\n</table>\n</div>\n";
}

/// Those that are not judged are folded behind one line.
std::string claims_html(const Section& section,
                        const Anchors& anchors,
                        Origin origin) {
  std::string judged, open;
  int count = 0;
  for (std::size_t k = 0; k < section.claims.size(); ++k) {
    const ClaimResult& c = section.claims[k];
    if (c.origin != origin) continue;
    const bool is_open = c.verdict == Verdict::not_judged;
    count += is_open ? 1 : 0;
    (is_open ? open : judged) +=
        claim_html(c, anchors.claims[k], shown_in(c, section, anchors));
  }
  if (judged.empty() && open.empty()) return "";
  const std::string title =
      origin == Origin::paper ? "What the paper says" : "Regression checks";
  std::string out = fmt::format("<h3>{}</h3>\n", title);
  if (!judged.empty()) out += claims_table_html(title, section, judged);
  if (!open.empty())
    out += fmt::format("<details>\n<summary>{} {}</summary>\n{}</details>\n",
                       count,
                       words_of(Verdict::not_judged),
                       claims_table_html(title, section, open));
  return out;
}

struct Kind {
  const char *ending, *words;
};

/// Links to the files of a table or figure, and the command that makes them.
std::string data_html(const std::string& folder,
                      const std::string& id,
                      std::initializer_list<Kind> kinds,
                      const std::string& command) {
  std::string out;
  for (const Kind& kind : kinds)
    out += fmt::format("{}<a href=\"{}{}{}\">{}</a>",
                       out.empty() ? "" : " · ",
                       folder,
                       html(id),
                       kind.ending,
                       kind.words);
  if (!command.empty()) out += " · <code>" + html(command) + "</code>";
  return "<p class=\"remark data\">" + out + "</p>\n";
}

}  // namespace

std::string command_of(const Section& section, const Json& provenance) {
  if (!provenance.is_object()) return "";
  if (provenance.contains("command"))
    return provenance["command"].get<std::string>();
  const std::string profile = provenance.value("profile", "");
  return profile.empty() ? ""
                         : fmt::format("./bench --profile={} --filter='^{}/'",
                                       profile,
                                       section.experiment);
}

namespace {

std::string head_html(const Section& section,
                      const Anchors& anchors,
                      const std::string& about) {
  std::string out = fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-title\">\n"
      "<h2 id=\"{0}-title\"><a class=\"self\" href=\"#{0}\">{1}</a> "
      "<code>{2}</code></h2>\n",
      anchors.section,
      html(section.title),
      html(section.experiment));
  if (!section.standing.empty())
    out += "<p class=\"answer\">" + html(section.standing) + ".</p>\n";
  const std::string papers = counts_html(tally(section, Origin::paper));
  if (!papers.empty())
    out += "<p class=\"counts\">The paper's statements: " + papers + "</p>\n";
  return out + about;
}

std::string figures_html(const Section& section,
                         const Anchors& anchors,
                         const Palette& palette,
                         const Beside& beside,
                         const std::string& within) {
  std::string out;
  if (!section.figures.empty()) out += "<h3>Figures</h3>\n";
  for (const std::size_t k : order_of(section.figures)) {
    const Figure& figure = section.figures[k];
    out += figure_html(figure, anchors.figures[k], palette) +
           said_of(figure.where, section, anchors);
    if (beside.folder)
      out += data_html(within + "figures/",
                       figure.id,
                       {{".svg", "SVG"},
                        {".json", "JSON"},
                        {".csv", "CSV"},
                        {".vl.json", "Vega-Lite"}},
                       beside.command);
  }
  return out;
}

std::string tables_html(const Section& section,
                        const Anchors& anchors,
                        const Beside& beside,
                        const std::string& within) {
  std::string out;
  if (!section.tables.empty()) out += "<h3>Tables</h3>\n";
  for (std::size_t k = 0; k < section.tables.size(); ++k) {
    const Table& table = section.tables[k];
    out += table_html(table, anchors.tables[k]) +
           said_of(table.where, section, anchors);
    if (beside.folder)
      out +=
          data_html(within + "tables/",
                    table.id,
                    {{".csv", "CSV"}, {".json", "JSON"}, {".md", "Markdown"}},
                    beside.command);
  }
  return out;
}

/// What the methods called and what they could skip.
std::string work_html(const Section& section) {
  if (!section.work) return "";
  const std::string text = work_text(*section.work, html, code_html);
  return text.empty() ? ""
                      : "<h3>Work</h3>\n<p class=\"remark\">" + text + "</p>\n";
}

}  // namespace

std::string section_html(const Section& section,
                         const Anchors& anchors,
                         const Palette& palette,
                         const Beside& beside) {
  const std::string within =
      beside.folder.value_or("").empty() ? "" : html(*beside.folder) + '/';
  std::string out = head_html(section, anchors, beside.about) +
                    figures_html(section, anchors, palette, beside, within) +
                    beside.pictures;
  if (!section.claims.empty()) {
    out += fmt::format("<div id=\"{}\">\n", anchors.statements);
    for (const Origin origin : {Origin::paper, Origin::suite})
      out += claims_html(section, anchors, origin);
    out += "</div>\n";
  }
  return out + tables_html(section, anchors, beside, within) +
         work_html(section) + "</section>\n";
}

}  // namespace physinv
