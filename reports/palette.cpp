#include "reports/palette.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>

namespace physinv {
namespace {

struct Color {
  std::string_view light, dark;
};

/// In the order of Hue.
constexpr Color kColors[] = {{"#1f6fb5", "#6cb2f2"},
                             {"#e07b00", "#ffab47"},
                             {"#2c8c3c", "#72d381"},
                             {"#c8322b", "#ff8178"},
                             {"#7b52ab", "#c09bee"},
                             {"#1b1b1b", "#f2f2f2"},
                             {"#8a5a44", "#cfa28a"},
                             {"#17808f", "#5fcbdb"},
                             {"#b5478e", "#f293d1"},
                             {"#6f6f6f", "#b0b0b0"},
                             {"#7d7a12", "#d3cf55"},
                             {"#3d4fb0", "#9fadff"}};
constexpr int kColorCount = static_cast<int>(std::size(kColors));
static_assert(kColorCount == static_cast<int>(Hue::indigo) + 1);
/// Given out to series without a style.
constexpr int kFirstFree = static_cast<int>(Hue::brown);

/// Lengths of ink and gaps of the classes d, d2, d3, ... of lines.
constexpr std::string_view kPatterns[] = {
    "", "6 4", ".1 4", ".1 8", "11 4 .1 4", "11 4 .1 4 .1 4", "16 4", "16 10"};
static_assert(std::size(kPatterns) == 2 * kDashes);

constexpr std::string_view kFurniture =
    "text{font-family:system-ui,-apple-system,'Segoe UI',Roboto,"
    "'Helvetica Neue',Arial,sans-serif}"
    ".title{font-size:15px;font-weight:600}"
    ".head{font-size:12.5px;font-weight:600}"
    ".label{font-size:12px}.tick{font-size:11px}.note{font-size:11px}"
    ".l{fill:none;stroke-width:1.9;stroke-linejoin:round;"
    "stroke-linecap:round}"
    ".e{fill:none;stroke-width:1.2}.b{stroke:none;opacity:.2}"
    ".m{stroke-width:1.3;stroke-linejoin:round}"
    ".o{stroke-width:1.6;stroke-linejoin:round}"
    ".x{stroke-width:2.2;fill:none}"
    ".arrow{fill:none;stroke:#fff;stroke-width:1.1;stroke-linecap:round}"
    ".halo{fill:none;stroke-width:4.2;stroke-linejoin:round;opacity:.75}"
    ".grid{fill:none;stroke-width:.8}.frame{fill:none;stroke-width:1}";

/// A pattern of short inks has round ends, which make dots of them.
std::string dash_rules() {
  std::string css;
  for (std::size_t k = 1; k < std::size(kPatterns); ++k)
    css += fmt::format(".d{}{{stroke-dasharray:{}{}}}",
                       k == 1 ? "" : std::to_string(k),
                       kPatterns[k],
                       kPatterns[k].find(".1") == kPatterns[k].npos
                           ? ";stroke-linecap:butt"
                           : "");
  return css;
}

std::string furniture_colors(bool dark) {
  const auto pick = [&](const char* l, const char* d) { return dark ? d : l; };
  return fmt::format(
      ".bg{{fill:{0}}}.halo{{stroke:{0}}}.m{{stroke:{0}}}.o{{fill:{0}}}"
      ".grid{{stroke:{1}}}.frame{{stroke:{2}}}"
      ".title,.head,.label{{fill:{3}}}.tick,.note{{fill:{4}}}",
      pick("#ffffff", "#14171c"),
      pick("#e7e8ea", "#2a2f37"),
      pick("#8d9198", "#727984"),
      pick("#1b1b1b", "#f0f0f0"),
      pick("#55585e", "#b3b8c0"));
}

std::string method_colors(bool dark) {
  std::string css;
  for (int i = 0; i < kColorCount; ++i) {
    css += fmt::format(".s{0}{{stroke:{1}}}.f{0}{{fill:{1}}}",
                       i,
                       dark ? kColors[i].dark : kColors[i].light);
  }
  return css;
}

std::string page_variables(bool dark) {
  std::string css = dark ? "color-scheme:dark;--bg:#14171c;--grid:#2a2f37;"
                           "--frame:#727984;--ink:#f0f0f0;--soft:#b3b8c0;"
                           "--yes:#72d381;--no:#ff8178;"
                         : "color-scheme:light;--bg:#ffffff;--grid:#e7e8ea;"
                           "--frame:#8d9198;--ink:#1b1b1b;--soft:#55585e;"
                           "--yes:#1d7a36;--no:#b3261e;";
  for (int i = 0; i < kColorCount; ++i) {
    css +=
        fmt::format("--c{}:{};", i, dark ? kColors[i].dark : kColors[i].light);
  }
  return css;
}

}  // namespace

std::string dash_css(Ink ink, bool dashed) {
  const int pattern = 2 * ink.dash + (dashed ? 1 : 0);
  return pattern == 0 ? "" : pattern == 1 ? " d" : fmt::format(" d{}", pattern);
}

std::vector<double> dash_pattern(Ink ink, bool dashed) {
  const auto pattern =
      static_cast<std::size_t>(2 * ink.dash + (dashed ? 1 : 0));
  std::vector<double> lengths;
  std::istringstream words{std::string(kPatterns[pattern])};
  for (double length = 0; words >> length;) lengths.push_back(length);
  return lengths;
}

std::string light_color(int color) { return std::string(kColors[color].light); }

namespace {

/// What most sections give a method; of equals the first.
std::map<std::string, Ink> usual_inks(const std::vector<Section>& sections) {
  struct Vote {
    Ink ink;
    int sections = 0;
    std::size_t last = SIZE_MAX;
  };
  std::map<std::string, std::vector<Vote>> votes;
  for (std::size_t k = 0; k < sections.size(); ++k)
    for (const Figure& figure : sections[k].figures)
      for (const Panel& panel : figure.panels)
        for (const Series& s : panel.series) {
          if (!s.style) continue;
          const Ink ink{static_cast<int>(s.style->hue), s.style->marker};
          auto& own = votes[s.method];
          auto vote = std::find_if(own.begin(), own.end(), [&](const Vote& v) {
            return v.ink == ink;
          });
          if (vote == own.end()) vote = own.insert(own.end(), {ink});
          if (vote->last != k) ++vote->sections;
          vote->last = k;
        }
  std::map<std::string, Ink> inks;
  for (const auto& [method, own] : votes)
    inks[method] = std::max_element(own.begin(),
                                    own.end(),
                                    [](const Vote& a, const Vote& b) {
                                      return a.sections < b.sections;
                                    })
                       ->ink;
  return inks;
}

}  // namespace

Palette::Palette(const std::vector<Section>& sections) {
  const auto each = [&](auto&& visit) {
    for (const Section& section : sections)
      for (const Figure& figure : section.figures)
        for (const Panel& panel : figure.panels)
          for (const Series& series : panel.series) visit(series);
  };
  methods_ = usual_inks(sections);
  each([&](const Series& s) { of(s); });
}

Palette::Entry Palette::entry_of(const Series& series) {
  return {series.label, series.method, series.dashed};
}

Ink Palette::next_free() {
  constexpr int kMarkers = static_cast<int>(Marker::cross);
  constexpr int kFree = kColorCount - kFirstFree;
  Ink ink;
  for (int tries = 0; tries < kFree * kMarkers * kDashes; ++tries) {
    const int order = others_++, round = order / kFree;
    ink = {kFirstFree + order % kFree,
           static_cast<Marker>((order % kFree + round / kDashes) % kMarkers),
           round % kDashes};
    if (std::none_of(methods_.begin(), methods_.end(), [&](const auto& known) {
          return known.second == ink;
        }))
      break;
  }
  return ink;
}

Ink Palette::of(const Series& series) {
  if (const auto at = entries_.find(entry_of(series)); at != entries_.end())
    return at->second;
  if (series.label.empty())
    if (const auto at = unnamed_.find(series.method); at != unnamed_.end())
      return at->second;
  if (const auto at = methods_.find(series.method); at != methods_.end())
    return at->second;
  const Ink ink = series.style ? Ink{static_cast<int>(series.style->hue),
                                     series.style->marker}
                               : next_free();
  return methods_[series.method] = ink;
}

void Palette::set(const Series& entry, Ink ink) {
  entries_[entry_of(entry)] = ink;
  unnamed_.try_emplace(entry.method, ink);
}

std::string style_sheet() {
  return fmt::format(
      "\n{}{}\n{}\n{}\n@media(prefers-color-scheme:dark){{\n{}\n{}\n}}\n",
      kFurniture,
      dash_rules(),
      furniture_colors(false),
      method_colors(false),
      furniture_colors(true),
      method_colors(true));
}

std::string page_style_sheet() {
  std::string css = fmt::format(
      ":root{{{0}}}\n"
      "@media screen and (prefers-color-scheme:dark){{"
      ":root:not([data-theme=light]){{{1}}}}}\n"
      "@media screen{{:root[data-theme=dark]{{{1}}}}}\n{2}{3}\n"
      ".halo{{stroke:var(--bg)}}.m{{stroke:var(--bg)}}.o{{fill:var(--bg)}}"
      ".grid{{stroke:var(--grid)}}.frame{{stroke:var(--frame)}}"
      ".head,.label{{fill:var(--ink)}}.tick{{fill:var(--soft)}}\n",
      page_variables(false),
      page_variables(true),
      kFurniture,
      dash_rules());
  for (int i = 0; i < kColorCount; ++i) {
    css +=
        fmt::format(".s{0}{{stroke:var(--c{0})}}.f{0}{{fill:var(--c{0})}}", i);
  }
  return css + '\n';
}

const std::array<std::string, kFieldColors>& field_colors() {
  static const auto colors = [] {
    // Viridis at twenty equidistant places (matplotlib, CC0).
    constexpr std::uint32_t kAt[] = {
        0x440154, 0x481567, 0x482677, 0x453781, 0x404788, 0x39568c, 0x33638d,
        0x2d708e, 0x287d8e, 0x238a8d, 0x1f968b, 0x20a387, 0x29af7f, 0x3cbb75,
        0x55c667, 0x73d055, 0x95d840, 0xb8de29, 0xdce319, 0xfde725};
    std::array<std::string, kFieldColors> out;
    for (int i = 0; i < kFieldColors; ++i) {
      const double at = 19.0 * i / (kFieldColors - 1);
      const int k = std::min(static_cast<int>(at), 18);
      std::string color = "#";
      for (const int shift : {16, 8, 0}) {
        const double a = (kAt[k] >> shift) & 0xFFU;
        const double b = (kAt[k + 1] >> shift) & 0xFFU;
        color += fmt::format("{:02x}", std::lround(a + (at - k) * (b - a)));
      }
      out[static_cast<std::size_t>(i)] = color;
    }
    return out;
  }();
  return colors;
}

}  // namespace physinv
