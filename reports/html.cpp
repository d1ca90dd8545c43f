#include "reports/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "reports/html_parts.h"
#include "reports/palette.h"
#include "reports/report.h"
#include "reports/svg.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

/// Class of a verdict in the page's style sheet.
std::string_view css_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "yes";
    case Verdict::not_reproduced:
      return "no";
    case Verdict::differs:
    case Verdict::depends:
    case Verdict::contradiction:
      return "why";
    case Verdict::partly_judged:
    case Verdict::not_judged:
    case Verdict::reported:
      break;
  }
  return "open";
}

/// Ids of everything that can be linked to, in the order of a section.
struct Anchors {
  std::string section;
  std::vector<std::string> claims, tables, figures;
};

class Ids {
 public:
  std::string make(const std::string& words) {
    std::string id;
    for (const char c : words) {
      id += std::isalnum(static_cast<unsigned char>(c)) || c == '_' ? c : '-';
    }
    std::string free = id;
    for (int k = 2; !taken_.insert(free).second; ++k) {
      free = fmt::format("{}-{}", id, k);
    }
    return free;
  }

 private:
  // Of the page itself.
  std::set<std::string> taken_{"top", "contents", "provenance"};
};

std::vector<Anchors> anchors_of(const std::vector<Section>& sections) {
  Ids ids;
  std::vector<Anchors> all;
  for (const Section& s : sections) {
    Anchors a{.section = ids.make(s.experiment)};
    const auto below = [&](const std::string& id) {
      return ids.make(s.experiment + '-' + id);
    };
    for (const auto& c : s.claims) a.claims.push_back(below(c.id));
    for (const auto& t : s.tables) a.tables.push_back(below(t.id));
    for (const auto& f : s.figures) a.figures.push_back(below(f.id));
    all.push_back(std::move(a));
  }
  return all;
}

std::string name_of(std::string_view source, std::string_view title) {
  if (source.empty()) return std::string(title);
  return title.empty() ? std::string(source)
                       : fmt::format("{} · {}", source, title);
}

std::string link(const std::string& id, const std::string& words) {
  return fmt::format("<a href=\"#{}\">{}</a>", id, html(words));
}

// ---- overview -------------------------------------------------------------

/// The paper's claims are what counts as reproduced; the suite's ranges are a
/// line below.
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
                       words_of(v, Origin::paper));
  }
  return out +
         fmt::format(
             "</ul>\n<p>Ranges of the suite, from earlier runs (regression "
             "checks): {}. {}</p>\n",
             tally_text(tally(sections, Origin::suite), Origin::suite),
             unmet == 0 ? "No gating claim (marked •) is missed."
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
        words_of(c.verdict, origin),
        html(c.says),
        mark_of(c.verdict),
        html(c.id),
        c.gates ? " •" : "");
  }
  return out;
}

std::string overview_html(const std::vector<Section>& sections,
                          const std::vector<Anchors>& anchors) {
  std::string out = totals_html(sections) +
                    "<div class=\"scroll\">\n<table class=\"overview\">\n"
                    "<caption class=\"hidden\">Claims by experiment</caption>\n"
                    "<thead>\n<tr><th scope=\"col\">experiment</th>";
  const auto columns = columns_of(tally(sections, Origin::paper));
  for (const Verdict v : columns) {
    out += fmt::format("<th scope=\"col\">{}</th>", words_of(v, Origin::paper));
  }
  out +=
      "<th scope=\"col\">the paper's claims</th>"
      "<th scope=\"col\">the suite's ranges</th></tr>\n</thead>\n<tbody>\n";
  for (std::size_t s = 0; s < sections.size(); ++s) {
    out += fmt::format("<tr><th scope=\"row\">{}</th>",
                       link(anchors[s].section, sections[s].title));
    const Tally counts = tally(sections[s], Origin::paper);
    for (const Verdict v : columns) {
      out += fmt::format("<td>{}<span class=\"word\"> {}</span></td>",
                         counts[static_cast<std::size_t>(v)],
                         words_of(v, Origin::paper));
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
                       link(a.section, "Claims"));
    for (std::size_t i = 0; i < s.tables.size(); ++i) {
      out += fmt::format(
          "<li>{}</li>\n",
          link(a.tables[i], name_of(s.tables[i].source, s.tables[i].title)));
    }
    for (std::size_t i = 0; i < s.figures.size(); ++i) {
      out += fmt::format(
          "<li>{}</li>\n",
          link(a.figures[i], name_of(s.figures[i].source, s.figures[i].title)));
    }
    out += "</ul>\n</details>\n";
  }
  return out + "<p>" + link("provenance", "Provenance") + "</p>\n</nav>\n";
}

// ---- an experiment --------------------------------------------------------

std::string claim_html(const ClaimResult& claim, const std::string& id) {
  std::string out = fmt::format(
      "<tr id=\"{0}\"><th scope=\"row\"><a class=\"self\" href=\"#{0}\">{1}</a>"
      "</th><td class=\"verdict {2}\">{3} {4}</td><td><p>{5}</p>",
      id,
      html(claim.id),
      css_of(claim.verdict),
      mark_of(claim.verdict),
      words_of(claim.verdict, claim.origin),
      html(claim.says));
  if (!claim.evidence.empty()) {
    out += fmt::format("<p class=\"evidence\">{}</p>", html(claim.evidence));
  }
  const std::string cause = cause_text(claim.verdict, claim.cause);
  if (!cause.empty())
    out += fmt::format("<p class=\"cause\">{}</p>", html(cause));
  if (!claim.note.empty())
    out += fmt::format("<p class=\"evidence\">{}</p>", html(claim.note));
  return out + fmt::format("<p class=\"evidence\">{}{}{}</p></td></tr>\n",
                           claim.where.empty() ? "" : html(claim.where) + " · ",
                           claim.gates ? "• gating" : "not gating",
                           claim.from.empty()
                               ? ""
                               : fmt::format(", judged from profile {}",
                                             html(claim.from)));
}

std::string claims_html(const Section& section,
                        const Anchors& anchors,
                        Origin origin) {
  std::string rows;
  for (std::size_t k = 0; k < section.claims.size(); ++k)
    if (section.claims[k].origin == origin)
      rows += claim_html(section.claims[k], anchors.claims[k]);
  if (rows.empty()) return "";
  const char* title =
      origin == Origin::paper ? "What the paper says" : "Ranges of the suite";
  return fmt::format(
             "<h3>{0}</h3>\n<div class=\"scroll\">\n"
             "<table class=\"claims\">\n<caption class=\"hidden\">{0}: {1}"
             "</caption>\n",
             title,
             html(section.title)) +
         "<thead class=\"hidden\">\n<tr><th scope=\"col\">id</th>"
         "<th scope=\"col\">verdict</th><th scope=\"col\">claim and "
         "evidence</th></tr>\n</thead>\n<tbody>\n" +
         rows + "</tbody>\n</table>\n</div>\n";
}

std::string section_html(const Section& section, const Anchors& anchors) {
  std::string out = fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-title\">\n"
      "<h2 id=\"{0}-title\"><a class=\"self\" href=\"#{0}\">{1}</a></h2>\n"
      "<p class=\"remark\"><code>{2}</code>{3}</p>\n",
      anchors.section,
      html(section.title),
      html(section.experiment),
      section.paper.empty() ? ""
                            : fmt::format(" · paper: {}", html(section.paper)));
  for (const Origin origin : {Origin::paper, Origin::suite})
    out += claims_html(section, anchors, origin);
  if (!section.tables.empty()) out += "<h3>Tables</h3>\n";
  for (std::size_t k = 0; k < section.tables.size(); ++k) {
    out += table_html(section.tables[k], anchors.tables[k]);
  }
  if (!section.figures.empty()) out += "<h3>Figures</h3>\n";
  for (std::size_t k = 0; k < section.figures.size(); ++k) {
    out += figure_html(section.figures[k], anchors.figures[k]);
  }
  return out + "</section>\n";
}

// ---- the page -------------------------------------------------------------

std::string plain(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.dump(1, ' ', false, Json::error_handler_t::replace);
}

std::string words_of(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

std::string provenance_html(const Json& provenance) {
  std::string out = "<footer id=\"provenance\">\n<h2>Provenance</h2>\n<dl>\n",
              more;
  if (provenance.is_object()) {
    for (const auto& [key, value] : provenance.items()) {
      if (value.is_null()) continue;
      if (value.is_structured()) {
        more += fmt::format(
            "<details>\n<summary>{}</summary>\n<pre>{}</pre>\n</details>\n",
            html(words_of(key)),
            html(plain(value)));
        continue;
      }
      out += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n",
                         html(words_of(key)),
                         html(plain(value)));
    }
  }
  return out + "</dl>\n" + more + "</footer>\n";
}

// Profile, date and processor, as far as they are known.
std::string summary_html(const Json& provenance) {
  std::string out;
  if (!provenance.is_object()) return out;
  for (const auto& [key, before] :
       {std::pair{"profile", "profile "}, {"date", ""}, {"cpu_model", ""}}) {
    if (!provenance.contains(key)) continue;
    if (!out.empty()) out += " · ";
    std::string words = plain(provenance[key]);
    if (std::string_view(key) == "date") words = words.substr(0, 10);
    out += before + html(words);
  }
  out = "<p class=\"remark\">" + out + "</p>\n";
  if (provenance.contains("papers"))
    for (const Json& paper : provenance["papers"])
      out += "<p class=\"remark\">" + html(plain(paper)) + "</p>\n";
  return out;
}

}  // namespace

std::string html(std::string_view text) {
  std::string lines(text);
  std::replace(lines.begin(), lines.end(), '\t', ' ');
  std::string out;
  for (std::size_t at = 0; at <= lines.size();) {
    const std::size_t end = std::min(lines.find('\n', at), lines.size());
    if (at > 0) out += '\n';
    out += svg_escape(std::string_view(lines).substr(at, end - at));
    at = end + 1;
  }
  return out;
}

std::string caption_html(const std::string& id,
                         std::string_view source,
                         std::string_view title) {
  return fmt::format("<a class=\"self\" href=\"#{}\">{}</a>",
                     id,
                     html(name_of(source, title)));
}

namespace {

/// Pages that are no report of reproductions bring their own.
std::string heading_of(const nlohmann::ordered_json& provenance) {
  const std::string usual = "Physics inverse problems: what is reproduced";
  return provenance.is_object() ? provenance.value("heading", usual) : usual;
}

}  // namespace

std::string report_html(const std::vector<Section>& sections,
                        const nlohmann::ordered_json& provenance) {
  const auto anchors = anchors_of(sections);
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
      "<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
      "'none'; img-src data:; style-src 'unsafe-inline'; script-src "
      "'unsafe-inline'\"/>\n"
      "<title>Physics inverse problems: report</title>\n<style>\n";
  out += page_style_sheet();
  out += kPageCss;
  out +=
      "</style>\n</head>\n<body>\n<div class=\"page\">\n"
      "<header id=\"top\">\n<h1>" +
      html(heading_of(provenance)) + "</h1>\n";
  out += summary_html(provenance) + overview_html(sections, anchors) +
         "</header>\n" + contents_html(sections, anchors) + "<main>\n";
  for (std::size_t k = 0; k < sections.size(); ++k) {
    out += section_html(sections[k], anchors[k]);
  }
  out += "</main>\n" + provenance_html(provenance) + "</div>\n<script>\n";
  out += kPageJs;
  return out + "</script>\n</body>\n</html>\n";
}

}  // namespace physinv
