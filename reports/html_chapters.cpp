#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "reports/anchors.h"
#include "reports/html_parts.h"
#include "reports/statements.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

/// Numbers of an experiment next to the paper's; statements that fail do not
/// count.
constexpr std::size_t kNumbers = 3;

bool is_open(const ClaimResult& claim) {
  return claim.verdict == Verdict::not_judged;
}

/// What does not hold as printed, or not all of it is known.
bool needs_words(Verdict verdict) {
  return verdict == Verdict::not_reproduced || is_explained(verdict) ||
         verdict == Verdict::partly_judged;
}

/// Numbers of a paper next to those measured here; statements that do not hold
/// have their own sentences.
std::string numbers_html(const std::vector<const Section*>& sections) {
  std::string rows;
  for (const Section* section : sections)
    for (const Statement& s : statements_of(*section, kNumbers)) {
      if (s.here.empty() || needs_words(s.verdict)) continue;
      rows += fmt::format(
          "<tr><th scope=\"row\"><a href=\"{}/index.html\">{}</a></th>"
          "<td class=\"what\">{}</td><td>{}</td><td class=\"paper\">{}</td>"
          "<td class=\"{}\">{} {}</td></tr>\n",
          html(folder_of(section->experiment)),
          html(section->title),
          html(s.what),
          html(s.here),
          html(s.paper),
          css_of(s.verdict),
          mark_of(s.verdict),
          words_of(s.verdict));
    }
  if (rows.empty()) return "";
  return "<div class=\"scroll\">\n<table class=\"numbers\">\n<thead>\n<tr>"
         "<th scope=\"col\">experiment</th><th scope=\"col\">statement</th>"
         "<th scope=\"col\">measured</th><th scope=\"col\">condition or "
         "printed</th>"
         "<th scope=\"col\">verdict</th></tr>\n</thead>\n<tbody>\n" +
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

/// Joined to what comes before; without the full stop that follows.
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
      words_of(c.verdict));
}

/// Statements that do not hold as printed, with what was measured and why:
/// what fails first, in the order of verdicts from there.
std::string failing_html(const Section& section) {
  const Anchors anchors = anchors_of({section}).front();
  const std::string folder = folder_of(section.experiment);
  std::string items;
  for (const Verdict verdict : {Verdict::not_reproduced,
                                Verdict::contradiction,
                                Verdict::depends,
                                Verdict::weaker,
                                Verdict::stronger,
                                Verdict::differs,
                                Verdict::partly_judged})
    for (std::size_t k = 0; k < section.claims.size(); ++k)
      if (section.claims[k].verdict == verdict)
        items += sentence_html(section.claims[k],
                               folder + "/index.html#" + anchors.claims[k]);
  return items.empty() ? ""
                       : fmt::format(
                             "<h4>{}</h4>\n<ul class=\"failing\">\n{}"
                             "</ul>\n",
                             html(section.title),
                             items);
}

/// One line for all statements that could not be judged.
std::string open_html(const std::vector<const Section*>& sections) {
  std::set<std::string> profiles;
  int count = 0;
  for (const Section* section : sections)
    for (const ClaimResult& c : section->claims)
      if (is_open(c)) ++count, profiles.insert(c.from);
  if (count == 0) return "";
  return fmt::format("<p class=\"remark\">{} {}; decided by profile {}</p>\n",
                     count,
                     words_of(Verdict::not_judged),
                     html(fmt::format("{}", fmt::join(profiles, ", "))));
}

/// Of all parts: what `of` says of each below its title, or nothing.
template <class Of>
std::string chapter_html(const char* id,
                         const char* title,
                         const std::vector<Part>& parts,
                         Of of) {
  std::string out;
  for (const Part& part : parts)
    if (const std::string own = of(part); !own.empty())
      out += "<h3>" + html(part.group.title) + "</h3>\n" + own;
  return out.empty() ? ""
                     : fmt::format(
                           "<section id=\"{0}\" aria-labelledby=\"{0}-title\">"
                           "\n<h2 id=\"{0}-title\">{1}</h2>\n{2}</section>\n",
                           id,
                           title,
                           out);
}

}  // namespace

std::string chapters_html(const std::vector<Part>& parts) {
  return chapter_html("deviations",
                      kDeviations,
                      parts,
                      [](const Part& part) {
                        std::string out;
                        for (const Section* s : part.sections)
                          out += failing_html(*s);
                        return out;
                      }) +
         chapter_html("numbers", kMeasured, parts, [](const Part& part) {
           const std::string table = numbers_html(part.sections);
           return table + open_html(part.sections);
         });
}

}  // namespace physinv
