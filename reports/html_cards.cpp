#include <fmt/format.h>

#include <algorithm>

#include "reports/html_parts.h"
#include "reports/key_figure.h"
#include "reports/plot.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

/// How the methods compare; else the first statement of the paper that was
/// decided, the reproduced ones first.
std::string answer_html(const Section& section) {
  if (!section.standing.empty()) return html(section.standing) + '.';
  for (const bool reproduced : {true, false})
    for (const ClaimResult& c : section.claims)
      if (c.origin == Origin::paper && c.verdict != Verdict::not_judged &&
          c.verdict != Verdict::reported &&
          (c.verdict == Verdict::reproduced) == reproduced)
        return fmt::format("{} <span class=\"{}\">{} {}</span>",
                           html(c.says),
                           css_of(c.verdict),
                           mark_of(c.verdict),
                           words_of(c.verdict));
  return "";
}

/// One image of a card, which leads to the page.
std::string image_html(const std::string& folder,
                       const char* name,
                       const std::string& shows,
                       int height) {
  return fmt::format(
      "<a href=\"{0}/index.html\" tabindex=\"-1\"><img src=\"{0}/{1}.svg\" "
      "alt=\"{2}\" width=\"{3}\" height=\"{4}\" loading=\"lazy\"/></a>\n",
      html(folder),
      name,
      html(shows),
      kCardWidth,
      height);
}

}  // namespace

std::string counts_html(const VerdictCounts& counts) {
  std::string out = verdicts_html(counts);
  const int open = counts[static_cast<std::size_t>(Verdict::not_judged)];
  if (open > 0)
    out += fmt::format("{}<span class=\"open\">{} {} {}</span>",
                       out.empty() ? "" : ", ",
                       mark_of(Verdict::not_judged),
                       open,
                       words_of(Verdict::not_judged));
  return out;
}

std::string card_html(const Section& section,
                      const std::string& folder,
                      const std::optional<std::string>& picture) {
  std::string out = fmt::format(
      "<article class=\"card\">\n<h3><a href=\"{0}/index.html\">{1}</a></h3>\n",
      html(folder),
      html(section.title));
  if (picture) out += image_html(folder, "card", *picture, kCardHeight);
  if (const auto both = before_and_after(section))
    out += image_html(folder, "card-picture", both->title, kCardHeight / 2);
  if (const std::string answer = answer_html(section); !answer.empty())
    out += "<p class=\"answer\">" + answer + "</p>\n";
  if (const std::string counts = counts_html(tally(section, Origin::paper));
      !counts.empty())
    out += "<p class=\"counts\">" + counts + "</p>\n";
  return out + "</article>\n";
}

}  // namespace physinv
