#include "reports/report.h"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <utility>

#include "reports/html.h"
#include "reports/html_parts.h"
#include "reports/key_figure.h"
#include "reports/plot.h"
#include "reports/tables.h"
#include "reports/vega_lite.h"
#include "suite/store/file.h"
#include "suite/store/folder.h"

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

  void write(const fs::path& name, std::string text) {
    pending_[name.parent_path()].emplace_back(name.filename(), std::move(text));
    files_.push_back(folder_.path() / name);
  }

  /// What waits is synced to the disk, a folder at a time: hundreds of small
  /// files would take as many syncs.
  void flush() {
    for (const auto& [place, files] : pending_) {
      std::optional<Folder> below;
      for (const auto& part : place)
        below = (below ? *below : folder_).make(part);
      FileGroup group(below ? *below : folder_);
      for (const auto& [name, text] : files) group.add(name, text);
      group.put_in_place();
    }
    pending_.clear();
  }

  std::vector<fs::path> files() && { return std::move(files_); }

 private:
  Folder folder_;
  std::map<fs::path, std::vector<std::pair<std::string, std::string>>> pending_;
  std::vector<fs::path> files_;
};

std::string dump(const Json& json, int indent = 1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + '\n';
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
    writer.write(base / (f.id + ".csv"), to_csv(f));
    writer.write(base / (f.id + ".vl.json"), dump(vega_lite(f, palette), -1));
    writer.write(base / (f.id + ".svg"), render_svg(f, palette));
  }
}

void write_page(Writer& writer,
                const Section& section,
                const Json& provenance,
                const Palette& palette,
                const Pages& pages) {
  const fs::path folder = folder_of(section.experiment);
  const auto pictures = pictures_of(pages, section);
  writer.write(folder / "index.html",
               section_page_html(section, provenance, palette, pictures));
  if (const auto card = card_svg(section, palette, pictures))
    writer.write(folder / "card.svg", *card);
  if (const auto both = before_and_after(section))
    writer.write(folder / "card-picture.svg", render_card(*both, palette));
}

}  // namespace

std::vector<Picture> pictures_of(const Pages& pages, const Section& section) {
  const auto own = pages.pictures.find(section.experiment);
  return own == pages.pictures.end() ? std::vector<Picture>() : own->second;
}

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

std::string tally_text(const Tally& tally) {
  std::string text;
  for (const Verdict v : columns_of(tally))
    text += fmt::format("{}{} {}",
                        text.empty() ? "" : ", ",
                        tally[static_cast<std::size_t>(v)],
                        words_of(v));
  return text;
}

std::vector<fs::path> write_report(const fs::path& dir,
                                   const std::vector<Section>& sections,
                                   const nlohmann::ordered_json& provenance,
                                   const Pages& pages) {
  Writer writer(dir);
  const Palette palette(sections);
  Json claims{{"schema_version", kClaimsVersion},
              {"provenance", provenance},
              {"sections", Json::array()}};
  for (std::size_t k = 0; k < sections.size(); ++k) {
    const Section& s = sections[k];
    write_section(writer, s, palette);
    if (!pages.one_file && k >= pages.front)
      write_page(writer, s, provenance, palette, pages);
    writer.flush();
    Json one{{"experiment", s.experiment},
             {"title", s.title},
             {"paper", s.paper},
             {"standing", s.standing},
             {"claims", Json::array()}};
    for (const ClaimResult& c : s.claims) one["claims"].push_back(to_json(c));
    claims["sections"].push_back(std::move(one));
  }
  writer.write("claims.json", dump(claims));
  writer.write("report.md", report_markdown(sections, provenance));
  writer.write("index.html",
               pages.one_file ? report_html(sections, provenance)
                              : index_html(sections, pages, provenance));
  writer.flush();
  return std::move(writer).files();
}

}  // namespace physinv
