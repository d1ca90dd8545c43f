#include "reports/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "reports/html.h"
#include "reports/plot.h"
#include "reports/tables.h"
#include "reports/text.h"
#include "suite/results/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string folder_of(const Section& section) {
  std::string name = section.experiment;
  std::replace(name.begin(), name.end(), '/', '-');
  return name;
}

class Writer {
 public:
  explicit Writer(fs::path dir) : dir_(std::move(dir)) {}

  void write(const fs::path& name, const std::string& text) {
    const fs::path path = dir_ / name;
    make_directory(path.parent_path());
    write_atomically(path, text);
    files_.push_back(path);
  }

  std::vector<fs::path> files() && { return std::move(files_); }

 private:
  fs::path dir_;
  std::vector<fs::path> files_;
};

std::string dump(const Json& json, int indent = 1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string one_line(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
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
           {"field", nullptr}};
  for (const Series& s : p.series) out["series"].push_back(to_json(s));
  if (p.field) {
    out["field"] = {{"label", p.field->label},
                    {"log_scale", p.field->log_scale},
                    {"x", p.field->x},
                    {"y", p.field->y},
                    {"values", p.field->values}};
  }
  return out;
}

std::string_view verdict_mark(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "✅ reproduced";
    case Verdict::not_reproduced:
      return "❌ not reproduced";
    case Verdict::not_judged:
      return "➖ not judged";
    case Verdict::reported:
      return "ℹ️ reported";
  }
  return "";
}

std::array<int, kVerdictCount> count_verdicts(
    const std::vector<Section>& sections) {
  std::array<int, kVerdictCount> counts{};
  for (const Section& s : sections) {
    for (const ClaimResult& c : s.claims) {
      ++counts[static_cast<std::size_t>(c.verdict)];
    }
  }
  return counts;
}

std::string summary(const std::vector<Section>& sections) {
  const auto [yes, no, open, told] = count_verdicts(sections);
  return fmt::format(
      "{} reproduced, {} not reproduced, {} not judged, {} reported",
      yes,
      no,
      open,
      told);
}

std::string claims_markdown(const Section& section) {
  std::string out =
      "| id | claim | verdict | judged from | gates | evidence |\n"
      "| -- | ----- | ------- | ----------- | ----- | -------- |\n";
  for (const ClaimResult& c : section.claims) {
    out += fmt::format("| {} | {} | {} | {} | {} | {} |\n",
                       c.id,
                       one_line(c.says),
                       verdict_mark(c.verdict),
                       c.from,
                       c.gates ? "yes" : "no",
                       one_line(c.evidence));
  }
  return out;
}

std::string section_markdown(const Section& section) {
  std::string out =
      fmt::format("\n## {} (`{}`)\n", section.title, section.experiment);
  if (!section.paper.empty()) {
    out += fmt::format("\nPaper: {}\n", section.paper);
  }
  if (!section.claims.empty()) {
    out += "\n### Claims\n\n" + claims_markdown(section);
  }
  if (!section.tables.empty()) out += "\n### Tables\n";
  for (const Table& t : section.tables) out += '\n' + to_markdown(t);
  if (!section.figures.empty()) out += "\n### Figures\n";
  for (const Figure& f : section.figures) {
    const std::string name =
        f.source.empty() ? f.title : f.source + " · " + f.title;
    out += fmt::format(
        "\n![{}]({}/figures/{}.svg)\n", name, folder_of(section), f.id);
    if (!f.note.empty()) out += '\n' + f.note + '\n';
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
        key,
        value.is_string() ? value.get<std::string>() : value.dump());
  }
  return out.empty() ? out : "\n" + out;
}

void write_section(Writer& writer, const Section& section) {
  const fs::path folder = folder_of(section);
  for (const Table& t : section.tables) {
    const fs::path base = folder / "tables";
    writer.write(base / (t.id + ".json"), dump(to_json(t)));
    writer.write(base / (t.id + ".csv"), to_csv(t));
    writer.write(base / (t.id + ".md"), to_markdown(t));
  }
  for (const Figure& f : section.figures) {
    const fs::path base = folder / "figures";
    writer.write(base / (f.id + ".json"), dump(to_json(f), -1));
    writer.write(base / (f.id + ".svg"), render_svg(f));
  }
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "reproduced";
    case Verdict::not_reproduced:
      return "not reproduced";
    case Verdict::not_judged:
      return "not judged";
    case Verdict::reported:
      return "reported";
  }
  return "";
}

nlohmann::ordered_json to_json(const Figure& figure) {
  Json out{{"id", figure.id},
           {"title", figure.title},
           {"source", figure.source},
           {"columns", figure.columns},
           {"panels", Json::array()},
           {"note", figure.note}};
  for (const Panel& p : figure.panels) out["panels"].push_back(to_json(p));
  return out;
}

nlohmann::ordered_json to_json(const ClaimResult& claim) {
  return {{"id", claim.id},
          {"says", claim.says},
          {"from", claim.from},
          {"gates", claim.gates},
          {"verdict", to_string(claim.verdict)},
          {"evidence", claim.evidence}};
}

std::vector<fs::path> write_report(const fs::path& dir,
                                   const std::vector<Section>& sections,
                                   const nlohmann::ordered_json& provenance) {
  Writer writer(dir);
  Json claims{{"provenance", provenance}, {"sections", Json::array()}};
  for (const Section& s : sections) {
    write_section(writer, s);
    Json one{{"experiment", s.experiment},
             {"title", s.title},
             {"paper", s.paper},
             {"claims", Json::array()}};
    for (const ClaimResult& c : s.claims) one["claims"].push_back(to_json(c));
    claims["sections"].push_back(std::move(one));
  }
  writer.write("claims.json", dump(claims));
  writer.write("report.md", report_markdown(sections, provenance));
  writer.write("index.html", report_html(sections, provenance));
  return std::move(writer).files();
}

std::string report_markdown(const std::vector<Section>& sections,
                            const nlohmann::ordered_json& provenance) {
  std::string out = "# Report\n\nClaims: " + summary(sections) + ".\n";
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
      if (!c.gates) words += " (reported, does not gate)";
      if (!c.evidence.empty()) words += " — " + c.evidence;
      if (c.verdict == Verdict::not_judged && !c.from.empty()) {
        words += fmt::format(" [needs profile {}]", c.from);
      }
      std::string head = "  " + pad_right(c.id, 4) + ' ';
      head = pad_right(head + std::string(to_string(c.verdict)), kIndent);
      const std::size_t room = width > kIndent + 20 ? width - kIndent : 20;
      for (const std::string& line : wrap(words, room)) {
        out += head + line + '\n';
        head.assign(kIndent, ' ');
      }
    }
  }
  return out + summary(sections) + '\n';
}

}  // namespace physinv
