#include "reports/html.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/anchors.h"
#include "reports/html_parts.h"
#include "reports/palette.h"
#include "reports/png.h"
#include "reports/report.h"
#include "reports/svg.h"

namespace physinv {

std::string_view css_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "yes";
    case Verdict::not_reproduced:
      return "no";
    case Verdict::stronger:
    case Verdict::weaker:
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

std::string verdicts_html(const VerdictCounts& counts) {
  std::string out;
  for (const Verdict v : kVerdicts) {
    const int count = counts[static_cast<std::size_t>(v)];
    if (count == 0 || v == Verdict::not_judged) continue;
    out += fmt::format("{}<span class=\"{}\">{} {} {}</span>",
                       out.empty() ? "" : ", ",
                       css_of(v),
                       mark_of(v),
                       count,
                       words_of(v));
  }
  return out;
}

std::string name_of(std::string_view where, std::string_view title) {
  if (where.empty()) return std::string(title);
  return title.empty() ? std::string(where)
                       : fmt::format("{} · {}", where, title);
}

namespace {

using Json = nlohmann::ordered_json;

std::string plain(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.dump(1, ' ', false, Json::error_handler_t::replace);
}

std::string words_of(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
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
                         std::string_view where,
                         std::string_view title) {
  return fmt::format(
      "<a class=\"self\" href=\"#{}\">{}</a>", id, html(name_of(where, title)));
}

std::string nil_html(const std::string& words) {
  return words.empty() ? "" : "<p class=\"nil\">" + html(words) + "</p>\n";
}

std::string heading_of(const Json& provenance) {
  const std::string usual = "Physics inverse problems: what is reproduced";
  return provenance.is_object() ? provenance.value("heading", usual) : usual;
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

std::string page_html(const PageParts& parts) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
      "<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
      "'none'; img-src " +
      std::string(parts.pictures ? "'self' " : "") +
      "data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\"/>\n"
      "<title>" +
      html(parts.title) + "</title>\n<style>\n";
  out += page_style_sheet();
  out += kPageCss;
  out +=
      "</style>\n</head>\n<body>\n<div class=\"page\">\n"
      "<header id=\"top\">\n";
  out += parts.header + "</header>\n" + parts.contents + "<main>\n" +
         parts.main + "</main>\n" + parts.footer + "</div>\n<script>\n";
  out += kPageJs;
  return out + "</script>\n</body>\n</html>\n";
}

std::string report_html(const std::vector<Section>& sections,
                        const nlohmann::ordered_json& provenance) {
  const auto anchors = anchors_of(sections);
  const Palette palette(sections);
  PageParts parts{.title = "Physics inverse problems: report"};
  parts.header = "<h1>" + html(heading_of(provenance)) + "</h1>\n" +
                 summary_html(provenance);
  // What claims nothing has nothing to count.
  if (std::any_of(sections.begin(), sections.end(), [](const Section& s) {
        return !s.claims.empty();
      }))
    parts.header += overview_html(sections, anchors);
  parts.contents = contents_html(sections, anchors);
  for (std::size_t k = 0; k < sections.size(); ++k)
    parts.main += section_html(sections[k], anchors[k], palette, {});
  parts.footer = provenance_html(provenance);
  return page_html(parts);
}

namespace {

/// Of "jpo: Ann Ames: Title", those of this key.
Json papers_of(const Json& papers, const std::string& key) {
  Json own = Json::array();
  for (const Json& paper : papers)
    if (paper.is_string() && paper.get<std::string>().starts_with(key + ": "))
      own.push_back(paper);
  return own;
}

}  // namespace

namespace {

std::string picture_html(const Picture& p) {
  return fmt::format(
      "<figure class=\"c1\">\n<figcaption>{0}</figcaption>\n"
      "<img src=\"{1}\" alt=\"{0}\"/>\n{2}</figure>\n",
      html(p.title),
      data_url(p.svg, "image/svg+xml"),
      p.note.empty() ? "" : "<p class=\"remark\">" + html(p.note) + "</p>\n");
}

}  // namespace

std::string section_page_html(const Section& section,
                              const nlohmann::ordered_json& provenance,
                              const Palette& palette,
                              const std::vector<Picture>& pictures) {
  const auto anchors = anchors_of({section});
  PageParts parts{.title = section.title + ": physics inverse problems"};
  Json own = provenance;
  if (own.is_object() && own.contains("papers"))
    own["papers"] = papers_of(own["papers"], section.paper);
  parts.header = "<p><a href=\"../index.html\">← All experiments</a></p>\n";
  parts.contents = contents_html({section}, anchors);
  Beside beside{.folder = "", .command = command_of(section, provenance)};
  beside.about = summary_html(own);
  if (!pictures.empty())
    beside.pictures =
        "<h3>Figures as they were published</h3>\n<p class=\"remark\">There is "
        "no picture of single problems: a published campaign does not store "
        "the unknowns that were found.</p>\n";
  for (const Picture& p : pictures) beside.pictures += picture_html(p);
  parts.main = section_html(section, anchors[0], palette, beside);
  parts.footer = provenance_html(own);
  return page_html(parts);
}

}  // namespace physinv
