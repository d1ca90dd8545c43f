#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "reports/anchors.h"
#include "reports/html.h"
#include "reports/html_parts.h"
#include "reports/statements.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

/// Beside the paper's, of an experiment; statements that fail do not count.
constexpr std::size_t kNumbers = 3;

std::string key_of(const Section& section) {
  return section.experiment.substr(0, section.experiment.find('/'));
}

bool is_open(const ClaimResult& claim) {
  return claim.verdict == Verdict::not_judged;
}

/// What does not hold as printed, or not all of it is known.
bool needs_words(Verdict verdict) {
  return verdict == Verdict::not_reproduced || is_explained(verdict) ||
         verdict == Verdict::partly_judged;
}

std::string numbers_html(const Section& section) {
  std::string rows;
  for (const Statement& s : statements_of(section, kNumbers)) {
    if (s.here.empty() || needs_words(s.verdict)) continue;
    rows += fmt::format(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"paper\">{}</td>"
        "<td class=\"{}\">{} {}</td></tr>\n",
        html(s.what),
        html(s.here),
        html(s.paper),
        css_of(s.verdict),
        mark_of(s.verdict),
        words_of(s.verdict, s.origin));
  }
  if (rows.empty()) return "";
  return "<div class=\"scroll\">\n<table class=\"numbers\">\n<thead>\n<tr>"
         "<th scope=\"col\">statement</th><th scope=\"col\">here</th>"
         "<th scope=\"col\">paper</th><th scope=\"col\">verdict</th></tr>\n"
         "</thead>\n<tbody>\n" +
         rows + "</tbody>\n</table>\n</div>\n";
}

/// What was measured where a condition does not hold; of one that is judged in
/// part, what was and what is missing; else all the evidence.
std::string measured_of(const ClaimResult& claim) {
  const bool partly = claim.verdict == Verdict::partly_judged;
  std::string text;
  const auto add = [&](const std::string& words) {
    text += (text.empty() ? "" : "; ") + words;
  };
  for (const ConditionResult& c : claim.conditions) {
    if (c.value && c.holds && *c.holds == partly)
      add(fmt::format("{} {}{} {}",
                      c.text(),
                      value_text(*c.value),
                      partly ? "," : ", not",
                      c.bounds));
    else if (partly && !c.missing.empty())
      add(c.text() + ": " + c.missing);
  }
  return text.empty() ? claim.evidence : text;
}

/// Joined to what stands before; without the full stop that follows.
std::string further(std::string_view words) {
  while (words.ends_with('.')) words.remove_suffix(1);
  return words.empty() ? "" : ". " + html(words);
}

std::string sentence_html(const ClaimResult& c, const std::string& page) {
  const std::string cause = cause_text(c.verdict, c.cause);
  return fmt::format(
      "<li><a href=\"{}\"><strong>{}</strong></a> {}{}: {}{}{} <span "
      "class=\"{}\">{} {}</span></li>\n",
      html(page),
      html(c.id),
      html(c.says),
      c.where.empty() ? "" : " (" + html(c.where) + ")",
      html(measured_of(c)),
      further(c.note),
      cause.empty() ? "" : ". <span class=\"cause\">" + html(cause) + "</span>",
      css_of(c.verdict),
      mark_of(c.verdict),
      words_of(c.verdict, c.origin));
}

/// Statements that do not hold as printed, with what was measured and why:
/// what fails first, in the order of verdicts from there.
std::string failing_html(const Section& section, const std::string& folder) {
  const Anchors anchors = anchors_of({section}).front();
  std::string items;
  for (const Verdict verdict : {Verdict::not_reproduced,
                                Verdict::contradiction,
                                Verdict::depends,
                                Verdict::differs,
                                Verdict::partly_judged})
    for (std::size_t k = 0; k < section.claims.size(); ++k)
      if (section.claims[k].verdict == verdict)
        items += sentence_html(section.claims[k],
                               folder + "/index.html#" + anchors.claims[k]);
  return items.empty() ? "" : "<ul class=\"failing\">\n" + items + "</ul>\n";
}

/// One line for all that nobody could judge.
std::string open_html(const Section& section) {
  std::set<std::string> profiles;
  int count = 0;
  for (const ClaimResult& c : section.claims)
    if (is_open(c)) ++count, profiles.insert(c.from);
  if (count == 0) return "";
  std::string from;
  for (const auto& profile : profiles)
    from += (from.empty() ? "" : ", ") + html(profile);
  return fmt::format("<p class=\"remark\">{} {}; decided by profile {}</p>\n",
                     count,
                     words_of(Verdict::not_judged, Origin::paper),
                     from);
}

std::string experiment_html(const Section& section) {
  const std::string folder = folder_of(section.experiment);
  const std::string papers =
      verdicts_html(tally(section, Origin::paper), Origin::paper);
  const std::string ranges =
      verdicts_html(tally(section, Origin::suite), Origin::suite);
  std::string out = fmt::format(
      "<article>\n<h3><a href=\"{}/index.html\">{}</a> <code>{}</code></h3>\n",
      html(folder),
      html(section.title),
      html(section.experiment));
  if (!papers.empty()) out += "<p>The paper: " + papers + "</p>\n";
  if (!ranges.empty())
    out += "<p class=\"remark\">Ranges of the suite: " + ranges + "</p>\n";
  if (!section.standing.empty())
    out += "<p class=\"remark\">" + html(section.standing) + ".</p>\n";
  return out + numbers_html(section) + failing_html(section, folder) +
         open_html(section) + "</article>\n";
}

std::string group_html(const Group& group,
                       const std::vector<Section>& sections) {
  std::string own;
  for (const Section& section : sections)
    if (key_of(section) == group.key) own += experiment_html(section);
  if (own.empty()) return "";
  std::string out = fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-title\">\n"
      "<h2 id=\"{0}-title\">{1}</h2>\n",
      html(group.key),
      html(group.title));
  if (!group.text.empty())
    out += fmt::format(
        "<p class=\"remark\">{}{}</p>\n",
        html(group.text),
        group.link.empty()
            ? ""
            : fmt::format(" <a href=\"{0}\">{0}</a>", html(group.link)));
  return out + own + "</section>\n";
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

std::string contents_html(const std::vector<Group>& groups,
                          const std::vector<Section>& sections) {
  std::string out = "<nav id=\"contents\" aria-label=\"Contents\">\n";
  for (const Group& group : groups) {
    std::string items;
    for (const Section& section : sections)
      if (key_of(section) == group.key)
        items += fmt::format("<li><a href=\"{}/index.html\">{}</a></li>\n",
                             html(folder_of(section.experiment)),
                             html(section.title));
    if (!items.empty())
      out += fmt::format(
          "<details>\n<summary>{}</summary>\n<ul>\n{}</ul>\n</details>\n",
          html(group.key),
          items);
  }
  return out + "<p><a href=\"#provenance\">Provenance</a></p>\n</nav>\n";
}

/// What claims nothing has nothing to count.
std::string tallies_html(const std::vector<Section>& sections) {
  if (std::all_of(sections.begin(), sections.end(), [](const Section& s) {
        return s.claims.empty();
      }))
    return "";
  return fmt::format(
      "<p>What the papers say: {}. Ranges of the suite: {}.</p>\n",
      tally_text(tally(sections, Origin::paper), Origin::paper),
      tally_text(tally(sections, Origin::suite), Origin::suite));
}

}  // namespace

std::string index_html(const std::vector<Section>& sections,
                       const Pages& pages,
                       const nlohmann::ordered_json& provenance) {
  const auto front = sections.begin() + static_cast<std::ptrdiff_t>(std::min(
                                            pages.front, sections.size()));
  const std::vector<Section> whole(sections.begin(), front),
      others(front, sections.end());
  const auto all = all_groups(pages.groups, others);
  PageParts parts{.title = "Physics inverse problems: report"};
  nlohmann::ordered_json brief = provenance;
  if (brief.is_object()) brief.erase("papers");  // the groups name them
  parts.header = "<h1>" + html(heading_of(provenance)) + "</h1>\n" +
                 summary_html(brief) + tallies_html(sections);
  parts.contents = contents_html(all, others);
  const auto anchors = anchors_of(whole);
  const Palette palette(sections);
  for (std::size_t k = 0; k < whole.size(); ++k)
    parts.main += section_html(whole[k],
                               anchors[k],
                               palette,
                               {.folder = folder_of(whole[k].experiment)});
  for (const Group& group : all) parts.main += group_html(group, others);
  parts.footer = provenance_html(brief);
  return page_html(parts);
}

}  // namespace physinv
