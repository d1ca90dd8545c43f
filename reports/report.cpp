#include "reports/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "reports/html.h"
#include "reports/html_parts.h"
#include "reports/plot.h"
#include "reports/tables.h"
#include "reports/text.h"
#include "suite/results/file.h"
#include "suite/results/folder.h"
#include "suite/results/markdown.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class Writer {
 public:
  explicit Writer(const fs::path& dir) {
    make_directory(dir);
    folder_ = Folder(dir);
  }

  void write(const fs::path& name, const std::string& text) {
    std::optional<Folder> below;
    for (const auto& part : name.parent_path())
      below = (below ? *below : folder_).make(part);
    (below ? *below : folder_).write(name.filename(), text);
    files_.push_back(folder_.path() / name);
  }

  std::vector<fs::path> files() && { return std::move(files_); }

 private:
  Folder folder_;
  std::vector<fs::path> files_;
};

std::string dump(const Json& json, int indent = 1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + '\n';
}

Json optional_number(std::optional<double> value) {
  return value ? Json(*value) : Json(nullptr);
}

Json to_json(const Series& s) {
  return {{"label", s.label},
          {"method", s.method},
          {"x", s.x},
          {"y", s.y},
          {"lo", s.lo},
          {"hi", s.hi},
          {"line", s.line},
          {"markers", s.markers},
          {"dashed", s.dashed}};
}

Json to_json(const Panel& p) {
  Json out{{"title", p.title},
           {"x_label", p.x_label},
           {"y_label", p.y_label},
           {"x_log", p.x_log},
           {"y_log", p.y_log},
           {"y_min", optional_number(p.y_min)},
           {"y_max", optional_number(p.y_max)},
           {"series", Json::array()},
           {"field", nullptr},
           {"arrows", nullptr}};
  for (const Series& s : p.series) out["series"].push_back(to_json(s));
  if (p.field) {
    out["field"] = {{"label", p.field->label},
                    {"log_scale", p.field->log_scale},
                    {"x", p.field->x},
                    {"x_names", p.field->x_names},
                    {"y_names", p.field->y_names},
                    {"y", p.field->y},
                    {"min", optional_number(p.field->min)},
                    {"max", optional_number(p.field->max)},
                    {"values", p.field->values}};
  }
  if (p.arrows) {
    out["arrows"] = {{"x", p.arrows->x},
                     {"y", p.arrows->y},
                     {"u", p.arrows->u},
                     {"v", p.arrows->v},
                     {"length", p.arrows->length}};
  }
  return out;
}

std::string summary(const std::vector<Section>& sections) {
  std::string text =
      fmt::format("claims of the papers {}",
                  tally_text(tally(sections, Origin::paper), Origin::paper));
  return text +
         fmt::format("; of the suite's ranges {}",
                     tally_text(tally(sections, Origin::suite), Origin::suite));
}

std::string claims_markdown(const Section& section, Origin origin) {
  std::string out;
  for (const ClaimResult& c : section.claims) {
    if (c.origin != origin) continue;
    if (out.empty())
      out = origin == Origin::paper
                ? "\n### What the paper says\n\n"
                : "\n### Ranges of the suite\n\nFrom earlier runs of this "
                  "code or of independent programs; regression checks.\n\n";
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
                       words_of(c.verdict, origin),
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
  for (const Origin origin : {Origin::paper, Origin::suite})
    out += claims_markdown(section, origin);
  if (!section.tables.empty()) out += "\n### Tables\n";
  for (const Table& t : section.tables) out += '\n' + to_markdown(t);
  if (!section.figures.empty()) out += "\n### Figures\n";
  for (const Figure& f : section.figures) {
    const std::string name =
        f.source.empty() ? f.title : f.source + " · " + f.title;
    out += fmt::format("\n![{}]({}/figures/{}.svg)\n",
                       markdown(name),
                       folder_of(section.experiment),
                       f.id);
    if (!f.note.empty()) out += '\n' + markdown(f.note) + '\n';
  }
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
  return out.empty() ? out : "\n" + out;
}

void write_section(Writer& writer,
                   const Section& section,
                   const Palette& palette) {
  const fs::path folder = folder_of(section.experiment);
  for (const Table& t : section.tables) {
    const fs::path base = folder / "tables";
    writer.write(base / (t.id + ".json"), dump(to_json(t)));
    writer.write(base / (t.id + ".csv"), to_csv(t));
    writer.write(base / (t.id + ".md"), to_markdown(t));
  }
  for (const Figure& f : section.figures) {
    const fs::path base = folder / "figures";
    writer.write(base / (f.id + ".json"), dump(to_json(f), -1));
    writer.write(base / (f.id + ".svg"), render_svg(f, palette));
  }
}

}  // namespace

std::string folder_of(std::string_view experiment) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  std::string name(experiment);
  for (char& c : name)
    if (kPlain.find(c) == std::string_view::npos) c = '-';
  if (name.empty() || name.front() == '.') name.insert(0, "_");
  return name;
}

Tally tally(const Section& section, Origin origin) {
  Tally counts{};
  for (const ClaimResult& c : section.claims)
    if (c.origin == origin) ++counts[static_cast<std::size_t>(c.verdict)];
  return counts;
}

Tally tally(const std::vector<Section>& sections, Origin origin) {
  Tally all{};
  for (const Section& s : sections) {
    const Tally one = tally(s, origin);
    for (std::size_t k = 0; k < all.size(); ++k) all[k] += one[k];
  }
  return all;
}

std::string tally_text(const Tally& tally, Origin origin) {
  std::string text;
  for (const Verdict v : columns_of(tally))
    text += fmt::format("{}{} {}",
                        text.empty() ? "" : ", ",
                        tally[static_cast<std::size_t>(v)],
                        words_of(v, origin));
  return text;
}

nlohmann::ordered_json to_json(const Figure& figure) {
  Json out{{"id", figure.id},
           {"title", figure.title},
           {"source", figure.source},
           {"columns", figure.columns},
           {"moment", figure.moment},
           {"panels", Json::array()},
           {"note", figure.note}};
  for (const Panel& p : figure.panels) out["panels"].push_back(to_json(p));
  return out;
}

namespace {

Json to_json(const std::vector<ConditionResult>& conditions) {
  Json out = Json::array();
  for (const ConditionResult& c : conditions) {
    const bool finite = c.value && std::isfinite(*c.value);
    out.push_back({{"label", c.label},
                   {"bounds", c.bounds},
                   {"value", finite ? Json(*c.value) : Json(nullptr)},
                   {"spread", optional_number(c.spread)},
                   {"runs", c.runs},
                   {"holds", c.holds ? Json(*c.holds) : Json(nullptr)},
                   {"missing", c.missing}});
  }
  return out;
}

std::vector<ConditionResult> conditions_from(const Json& list) {
  const auto number = [](const Json& value) {
    return value.is_number() ? std::optional(value.get<double>())
                             : std::nullopt;
  };
  std::vector<ConditionResult> out;
  for (const Json& c : list) {
    const Json& holds = c.at("holds");
    out.push_back({.label = c.at("label"),
                   .bounds = c.at("bounds"),
                   .value = number(c.at("value")),
                   .spread = number(c.at("spread")),
                   .runs = c.at("runs"),
                   .holds = holds.is_boolean()
                                ? std::optional(holds.get<bool>())
                                : std::nullopt,
                   .missing = c.at("missing")});
    // One that is not finite is null, and was decided about all the same.
    if (!out.back().value && out.back().holds) out.back().value = INFINITY;
  }
  return out;
}

}  // namespace

nlohmann::ordered_json to_json(const ClaimResult& claim) {
  return {{"id", claim.id},
          {"says", claim.says},
          {"from", claim.from},
          {"gates", claim.gates},
          {"verdict", words_of(claim.verdict, claim.origin)},
          {"evidence", claim.evidence},
          {"origin", claim.origin == Origin::paper ? "paper" : "suite"},
          {"where", claim.where},
          {"note", claim.note},
          {"cause", claim.cause},
          {"conditions", to_json(claim.conditions)},
          {"shown_by", to_json(claim.shown_by)}};
}

ClaimResult claim_from(const Json& claim) {
  const std::string words = claim.at("verdict");
  const auto verdict = verdict_of(words);
  if (!verdict)
    throw std::runtime_error(
        fmt::format("no digest of a campaign: '{}' is no verdict", words));
  const bool paper = claim.at("origin") == "paper";
  return {
      .id = claim.at("id"),
      .says = claim.at("says"),
      .from = claim.value("from", ""),
      .gates = claim.value("gates", true),
      .verdict = *verdict,
      .evidence = claim.at("evidence"),
      .origin = paper ? Origin::paper : Origin::suite,
      .where = claim.value("where", ""),
      .note = claim.value("note", ""),
      .conditions = conditions_from(claim.value("conditions", Json::array())),
      .cause = claim.value("cause", ""),
      .shown_by = conditions_from(claim.value("shown_by", Json::array()))};
}

std::vector<fs::path> write_report(const fs::path& dir,
                                   const std::vector<Section>& sections,
                                   const nlohmann::ordered_json& provenance,
                                   const Pages& pages) {
  Writer writer(dir);
  const Palette palette(sections);
  Json claims{{"provenance", provenance}, {"sections", Json::array()}};
  for (const Section& s : sections) {
    write_section(writer, s, palette);
    if (!pages.one_file)
      writer.write(fs::path(folder_of(s.experiment)) / "index.html",
                   section_page_html(s, provenance, palette));
    Json one{{"experiment", s.experiment},
             {"title", s.title},
             {"paper", s.paper},
             {"claims", Json::array()}};
    for (const ClaimResult& c : s.claims) one["claims"].push_back(to_json(c));
    claims["sections"].push_back(std::move(one));
  }
  writer.write("claims.json", dump(claims));
  writer.write("report.md", report_markdown(sections, provenance));
  std::vector<std::string> folders;
  for (const Section& s : sections) folders.push_back(folder_of(s.experiment));
  writer.write("index.html",
               pages.one_file
                   ? report_html(sections, provenance)
                   : index_html(sections, folders, pages.groups, provenance));
  return std::move(writer).files();
}

std::string report_markdown(const std::vector<Section>& sections,
                            const nlohmann::ordered_json& provenance) {
  std::string out = "# Report\n\nOf the " + summary(sections) + ".\n";
  out += provenance_markdown(provenance);
  for (const Section& s : sections) out += section_markdown(s);
  return out;
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
      head += words_of(c.verdict, c.origin);
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
