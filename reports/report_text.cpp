#include <fmt/format.h>

#include "reports/anchors.h"
#include "reports/report.h"
#include "reports/tables.h"
#include "reports/text.h"
#include "suite/results/markdown.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

std::string summary(const std::vector<Section>& sections) {
  std::string text = fmt::format("claims of the papers {}",
                                 tally_text(tally(sections, Origin::paper)));
  return text + fmt::format("; regression checks {}",
                            tally_text(tally(sections, Origin::suite)));
}

std::string claims_markdown(const Section& section, Origin origin) {
  std::string out;
  for (const ClaimResult& c : section.claims) {
    if (c.origin != origin) continue;
    if (out.empty())
      out = origin == Origin::paper
                ? "\n### What the paper says\n\n"
                : "\n### Regression checks\n\nRanges from earlier runs of this "
                  "code or of independent programs.\n\n";
    if (out.ends_with("\n\n"))
      out +=
          "| id | claim | verdict | judged from | gates | evidence |\n"
          "| -- | ----- | ------- | ----------- | ----- | -------- |\n";
    const std::string place =
        c.where.empty() ? "" : fmt::format(" ({})", markdown(c.where));
    const std::string note =
        c.note.empty() ? "" : fmt::format(" *{}*", markdown(c.note));
    const std::string cause = cause_text(c.verdict, c.cause);
    out += fmt::format("| {} | {}{} | {} {} | {} | {} | {}{}{}{} |\n",
                       markdown(c.id),
                       markdown(c.says),
                       place,
                       mark_of(c.verdict),
                       words_of(c.verdict),
                       markdown(c.from),
                       c.gates ? "yes" : "no",
                       markdown(c.evidence),
                       cause.empty() ? "" : " ",
                       cause.empty() ? "" : "**" + markdown(cause) + "**",
                       note);
  }
  return out;
}

std::string section_markdown(const Section& section) {
  std::string out = fmt::format("\n## {} ({})\n",
                                markdown(section.title),
                                markdown_code(section.experiment));
  if (!section.paper.empty())
    out += fmt::format("\nPaper: {}\n", markdown(section.paper));
  if (!section.standing.empty())
    out += fmt::format("\n{}.\n", markdown(section.standing));
  if (!section.figures.empty()) out += "\n### Figures\n";
  for (const std::size_t k : order_of(section.figures)) {
    const Figure& f = section.figures[k];
    const std::string name =
        f.where.empty() ? f.title : f.where + " · " + f.title;
    out += fmt::format("\n![{}]({}/figures/{}.svg)\n",
                       markdown(name),
                       folder_of(section.experiment),
                       f.id);
    if (!f.note.empty()) out += '\n' + markdown(f.note) + '\n';
  }
  for (const Origin origin : {Origin::paper, Origin::suite})
    out += claims_markdown(section, origin);
  if (!section.tables.empty()) out += "\n### Tables\n";
  for (const Table& t : section.tables) out += '\n' + to_markdown(t);
  return out;
}

std::string provenance_markdown(const Json& provenance) {
  std::string out;
  if (!provenance.is_object()) return out;
  for (const auto& [key, value] : provenance.items()) {
    if (value.is_structured() || value.is_null()) continue;
    out += fmt::format(
        "- {}: {}\n",
        markdown(key),
        markdown(value.is_string() ? value.get<std::string>() : value.dump()));
  }
  return out.empty() ? out : "\n## Provenance\n\n" + out;
}

}  // namespace

std::string report_markdown(const std::vector<Section>& sections,
                            const nlohmann::ordered_json& provenance) {
  std::string out = "# Report\n\nOf the " + summary(sections) + ".\n";
  for (const Section& s : sections) out += section_markdown(s);
  return out + provenance_markdown(provenance);
}

std::string render_claims_text(const std::vector<Section>& sections,
                               std::size_t width) {
  constexpr std::size_t kIndent = 24;
  std::string out;
  for (const Section& s : sections) {
    out += fmt::format("{} ({})\n", s.title, s.experiment);
    for (const ClaimResult& c : s.claims) {
      std::string words = c.says;
      if (!c.where.empty()) words += fmt::format(" ({})", c.where);
      if (!c.gates) words += " (does not gate)";
      if (!c.evidence.empty()) words += " — " + c.evidence;
      const std::string cause = cause_text(c.verdict, c.cause);
      if (!cause.empty()) words += fmt::format(" {{{}}}", cause);
      if (!c.note.empty()) words += fmt::format(" [{}]", c.note);
      std::string head = "  " + pad_right(c.id, 4) + ' ';
      head += words_of(c.verdict);
      head = pad_right(head, kIndent);
      const std::size_t room = width > kIndent + 20 ? width - kIndent : 20;
      for (const std::string& line : wrap(words, room)) {
        out += head + line + '\n';
        head.assign(kIndent, ' ');
      }
    }
  }
  for (const std::string& line : wrap("Of the " + summary(sections), width))
    out += line + '\n';
  return out;
}

}  // namespace physinv
