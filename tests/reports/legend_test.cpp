#include "reports/legend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace physinv {
namespace {

Series series(std::string label, std::string method, bool dashed = false) {
  return {.label = std::move(label),
          .method = std::move(method),
          .x = {1, 2},
          .y = {1, 2},
          .dashed = dashed};
}

Figure figure_of(std::vector<Series> all) {
  return {.id = "f", .title = "T", .panels = {{.series = std::move(all)}}};
}

/// How many entries of a legend look like an earlier one.
std::size_t alike(const Figure& figure, const Palette& report = {}) {
  Palette palette = palette_of(figure, report);
  std::set<DrawnStyle> styles;
  std::size_t count = 0;
  for (const Series* entry : legend_of(figure))
    count +=
        styles.insert(drawn_style(*entry, palette.of(*entry))).second ? 0 : 1;
  return count;
}

TEST(Legend, NoTwoEntriesLookAlike) {
  std::vector<Series> many;
  for (int k = 0; k < 24; ++k)
    many.push_back(series("m" + std::to_string(k), "m" + std::to_string(k)));
  EXPECT_EQ(alike(figure_of(many)), 0U);
  for (Series& s : many) s.style = PlotStyle{Hue::blue, Marker::circle};
  EXPECT_EQ(alike(figure_of(many)), 0U) << "with the same style";
  for (Series& s : many) s.method = "one", s.style = {};
  EXPECT_EQ(alike(figure_of(many)), 0U) << "of one method";
  for (Series& s : many) s.line = false, s.markers = true;
  EXPECT_EQ(alike(figure_of(many)), 0U) << "points alone";
  EXPECT_EQ(alike(figure_of({series("a", "m"),
                             series("a refined", "m", true),
                             series("b", "n"),
                             series("b refined", "n", true)})),
            0U);
}

TEST(Legend, AMethodLooksTheSameInEveryFigure) {
  auto first = series("Adam", "adam");
  first.style = PlotStyle{Hue::purple, Marker::down};
  std::vector<Section> sections(2);
  sections[0].figures = {figure_of({series("x", "x"), first})};
  sections[1].figures = {
      figure_of({series("y", "y"), series("adam", "adam"), series("x", "x")})};
  const Palette report(sections);
  Palette one = palette_of(sections[0].figures[0], report),
          other = palette_of(sections[1].figures[0], report);
  for (const char* method : {"adam", "x"})
    EXPECT_EQ(one.of(series("", method)), other.of(series("", method)));
  EXPECT_EQ(other.of(series("adam", "adam")).color,
            static_cast<int>(Hue::purple));
  EXPECT_NE(other.of(series("", "x")), other.of(series("", "y")));
}

TEST(Legend, AMethodLooksAsMostSectionsHaveIt) {
  const auto section = [](Hue hue) {
    Section s;
    s.figures = {figure_of({series("gd", "gd"), series("gd", "gd")})};
    for (Series& one : s.figures[0].panels[0].series)
      one.style = PlotStyle{hue, {}};
    return s;
  };
  Palette most({section(Hue::blue), section(Hue::red), section(Hue::red)});
  EXPECT_EQ(most.of(series("", "gd")).color, static_cast<int>(Hue::red));
  Palette equal({section(Hue::blue), section(Hue::red)});
  EXPECT_EQ(equal.of(series("", "gd")).color, static_cast<int>(Hue::blue));
}

TEST(Legend, HasWhatIsDrawn) {
  const Series drawn = series("drawn", "a"), missing{.label = "missing"};
  Series infinite = series("infinite", "c");
  infinite.y = {INFINITY, NAN};
  const Figure figure = figure_of({drawn, missing, infinite});
  ASSERT_EQ(legend_of(figure).size(), 1U);
  EXPECT_EQ(undrawn_text(figure),
            "not run: missing; no finite number: infinite");
  EXPECT_EQ(undrawn_text(figure_of({missing})), "") << "the panel says so";
  EXPECT_EQ(undrawn_text(figure_of({drawn})), "");
}

TEST(Legend, AsManyInksAsMethods) {
  Palette palette;
  std::set<Ink> inks;
  for (int k = 0; k < 60; ++k)
    inks.insert(palette.of(series("", "m" + std::to_string(k))));
  EXPECT_EQ(inks.size(), 60U);
}

TEST(Legend, PatternsOfLinesDiffer) {
  std::set<std::string> patterns;
  for (int dash = 0; dash < kDashes; ++dash)
    for (const bool dashed : {false, true})
      patterns.insert(dash_css({.dash = dash}, dashed));
  EXPECT_EQ(patterns.size(), 2U * kDashes);
  for (const auto& css : patterns)
    if (!css.empty()) {
      EXPECT_NE(style_sheet().find("." + css.substr(1) + "{stroke-dasharray"),
                std::string::npos)
          << css;
    }
}

}  // namespace
}  // namespace physinv
