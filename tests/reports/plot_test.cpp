#include "reports/plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/reports/xml_check.h"

namespace physinv {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != text.npos;
       at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

Figure one_panel(Panel panel) {
  return {.id = "f", .title = "T", .panels = {std::move(panel)}, .columns = 1};
}

TEST(RenderSvg, SameFigureSameBytes) {
  Panel panel{.title = "p", .x_log = true, .y_log = true};
  panel.series.push_back({.label = "JPO",
                          .method = "jpo",
                          .x = {1, 2, 4},
                          .y = {1, 0.1, 0.01},
                          .lo = {0.5, -1, 0.001},
                          .hi = {2, 1, 1},
                          .markers = true,
                          .look = Look{Hue::orange, Marker::square}});
  const std::string a = render_svg(one_panel(panel));
  EXPECT_EQ(a, render_svg(one_panel(panel)));
  EXPECT_EQ(xml_error(a), "");
  EXPECT_EQ(count(a, "prefers-color-scheme:dark"), 1U);
  EXPECT_EQ(count(a, "<script"), 0U);
  EXPECT_EQ(count(a, "class=\"e s1\""), 1U);
}

TEST(RenderSvg, WhatCannotBeShownIsAGap) {
  Panel panel{.y_log = true};
  panel.series.push_back({.label = "a & <b>",
                          .method = "bfgs",
                          .x = {0, 1, 2, 3, 4, 5, 6},
                          .y = {1, 2, kNaN, 3, 4, 0, kInf}});
  const std::string svg = render_svg(one_panel(panel));
  EXPECT_EQ(xml_error(svg), "");
  EXPECT_EQ(count(svg, "nan"), 0U);
  EXPECT_EQ(count(svg, "inf"), 0U);
  const std::size_t at = svg.find("class=\"l s6\" d=");
  ASSERT_NE(at, svg.npos);
  const std::string path = svg.substr(at, svg.find("/>", at) - at);
  EXPECT_EQ(count(path, "M"), 2U);
  EXPECT_EQ(count(path, "L"), 2U);
}

TEST(RenderSvg, EmptyReadsNotRun) {
  EXPECT_EQ(count(render_svg({.id = "f", .title = "T"}), "not run"), 1U);
  Panel panel;
  EXPECT_EQ(count(render_svg(one_panel(panel)), ">not run<"), 1U);
  panel.series.push_back({.label = "JPO", .method = "jpo"});
  panel.series.push_back({.label = "NA", .x = {1, 2}, .y = {kNaN, kNaN}});
  const std::string svg = render_svg(one_panel(panel));
  EXPECT_EQ(count(svg, ">not run<"), 1U);
  EXPECT_EQ(xml_error(svg), "");
}

TEST(RenderSvg, LengthsThatDisagreeAreCut) {
  Panel panel;
  panel.series.push_back(
      {.label = "s", .x = {1, 2, 3}, .y = {1, 2}, .lo = {0}, .hi = {}});
  EXPECT_EQ(xml_error(render_svg(one_panel(panel))), "");
}

TEST(RenderSvg, LargeFieldsStaySmall) {
  Field2D field;
  field.log_scale = true;
  field.label = "loss";
  for (int i = 0; i < 400; ++i) field.x.push_back(i), field.y.push_back(i);
  unsigned noise = 1;
  for (std::size_t k = 0; k < 400 * 400; ++k) {
    noise = noise * 1664525U + 1013904223U;
    field.values.push_back(k % 1000 == 0 ? kNaN : 1e-3 + noise / 4e9);
  }
  Panel panel;
  panel.field = field;
  const std::string svg = render_svg(one_panel(panel));
  EXPECT_EQ(xml_error(svg), "");
  EXPECT_LT(svg.size(), 300'000U);
}

TEST(RenderSvg, FieldsOfOneValueOrNoneDoNotCrash) {
  Panel panel;
  panel.field = Field2D{.x = {0, 1}, .y = {0, 1}, .values = {1, 1, 1, 1}};
  EXPECT_EQ(xml_error(render_svg(one_panel(panel))), "");
  panel.field->values = {kNaN, kNaN, kNaN, kNaN};
  EXPECT_EQ(xml_error(render_svg(one_panel(panel))), "");
  panel.field->values = {1};
  EXPECT_EQ(xml_error(render_svg(one_panel(panel))), "");
  panel.field = Field2D{.x = {1}, .y = {1}, .values = {2}};
  EXPECT_EQ(xml_error(render_svg(one_panel(panel))), "");
}

TEST(RenderSvg, MethodsHaveTheLookOfTheirCase) {
  const auto series = [](const char* method) {
    return Series{.label = method, .method = method, .x = {1}, .y = {1}};
  };
  std::vector<Figure> figures = {
      one_panel({.series = {series("x"), series("na"), series("x")}})};
  apply({{"na", {Hue::red, Marker::diamond}}, {"other", {}}}, figures);
  EXPECT_FALSE(figures[0].panels[0].series[0].look);
  const std::string svg = render_svg(figures[0]);
  EXPECT_EQ(count(svg, "class=\"l s3\""), 2U);  // legend and curve
  EXPECT_EQ(count(svg, "class=\"l s6\""), 3U);  // one method, one colour
}

}  // namespace
}  // namespace physinv
