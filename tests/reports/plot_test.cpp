#include "reports/plot.h"

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "reports/palette.h"
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
                          .style = PlotStyle{Hue::orange, Marker::square}});
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

/// SVG 1.1's name of it is the one that all programs know.
TEST(RenderSvg, PicturesHaveTheNameThatAllProgramsKnow) {
  Panel panel;
  panel.field = Field2D{.x = {0, 1}, .y = {0, 1}, .values = {1, 2, 3, 4}};
  const std::string svg = render_svg(one_panel(panel));
  EXPECT_EQ(count(svg, " xlink:href=\"data:"), 2U);
  EXPECT_EQ(count(svg, " xmlns:xlink=\"http://www.w3.org/1999/xlink\""), 2U);
  EXPECT_EQ(count(svg, " href="), 0U);
}

/// The bytes behind "base64," up to the next quotation mark.
std::string from_base64(const std::string& svg) {
  const std::string digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto begin = svg.find("data:image/png;base64,") + 22;
  std::string out;
  unsigned bits = 0, held = 0;
  for (const char c : svg.substr(begin, svg.find('"', begin) - begin)) {
    if (c == '=') break;
    bits = bits << 6U | static_cast<unsigned>(digits.find(c));
    held += 6;
    if (held < 8) continue;
    held -= 8;
    out += static_cast<char>(bits >> held & 255U);
  }
  return out;
}

struct Pixels {
  unsigned width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 4>> rgba;  ///< row by row, from the top
};

Pixels decoded(const std::string& png) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0)
      << image.message;
  image.format = PNG_FORMAT_RGBA;
  Pixels out{image.width, image.height, {}};
  out.rgba.resize(std::size_t{image.width} * image.height);
  EXPECT_NE(png_image_finish_read(&image, nullptr, out.rgba.data(), 0, nullptr),
            0)
      << image.message;
  return out;
}

/// The middle of each block, of which there are nx x ny; blocks have one
/// colour.
Pixels decoded(const std::string& png, unsigned nx, unsigned ny) {
  const Pixels fine = decoded(png);
  const unsigned times = fine.width / nx;
  EXPECT_EQ(fine.width, nx * times);
  EXPECT_EQ(fine.height, ny * times);
  Pixels out{nx, ny, {}};
  for (unsigned j = 0; j < ny; ++j)
    for (unsigned i = 0; i < nx; ++i)
      out.rgba.push_back(fine.rgba[(j * times + times / 2) * fine.width +
                                   i * times + times / 2]);
  for (std::size_t at = 0; at < fine.rgba.size(); ++at)
    EXPECT_EQ(fine.rgba[at],
              out.rgba[at / fine.width / times * nx + at % fine.width / times]);
  return out;
}

std::array<std::uint8_t, 4> color(int k) {
  const auto rgb = std::stoul(
      field_colors()[static_cast<std::size_t>(k)].substr(1), nullptr, 16);
  return {static_cast<std::uint8_t>(rgb >> 16U),
          static_cast<std::uint8_t>(rgb >> 8U),
          static_cast<std::uint8_t>(rgb),
          255};
}

// A block a cell, y upwards; what cannot be shown is transparent.
TEST(RenderSvg, FieldsArePixels) {
  Panel panel;
  panel.field =
      Field2D{.x = {0, 1, 2}, .y = {0, 1}, .values = {0, 1, kNaN, 0.5, 1, 0}};
  const Pixels is = decoded(from_base64(render_svg(one_panel(panel))), 3, 2);
  EXPECT_EQ(is.rgba[0], color(kFieldColors / 2));
  EXPECT_EQ(is.rgba[1], color(kFieldColors - 1));
  EXPECT_EQ(is.rgba[2], color(0));
  EXPECT_EQ(is.rgba[3], color(0));
  EXPECT_EQ(is.rgba[4], color(kFieldColors - 1));
  EXPECT_EQ(is.rgba[5][3], 0);
}

/// Width and height of the last frame, a panel's: its colour bar comes before.
std::array<double, 2> frame_of(const std::string& svg) {
  const auto at = svg.rfind("class=\"frame\"");
  const auto number = [&](const char* name) {
    return std::stod(svg.substr(svg.find(name, at) + std::strlen(name)));
  };
  return {number(" width=\""), number(" height=\"")};
}

// One unit is as long along x as along y, whatever the panel's width, and a
// point has its place.
TEST(RenderSvg, PlacesKeepTheirShape) {
  Panel panel{.title = "p",
              .y_min = 0,
              .y_max = 2,
              .x_min = -1,
              .x_max = 4,
              .space = true};
  panel.series.push_back(
      {.label = "s", .x = {-1, 4}, .y = {0, 2}, .style = PlotStyle{}});
  Figure figure = one_panel(panel);
  const auto [w, h] = frame_of(render_svg(figure));
  EXPECT_NEAR(h / w, 2.0 / 5, 1e-3);
  EXPECT_EQ(count(render_svg(figure), "class=\"tick\""), 0U);
  figure.panels.assign(3, panel), figure.columns = 3;
  const auto [narrow, low] = frame_of(render_svg(figure));
  EXPECT_LT(narrow, w);
  EXPECT_NEAR(low / narrow, 2.0 / 5, 1e-3);
  panel.field = Field2D{.x = {0, 1, 2}, .y = {0, 1, 2, 3, 4, 5}};
  panel.field->values.assign(18, 1);
  const auto [a, b] = frame_of(render_svg(one_panel(panel)));
  EXPECT_NEAR(b / a, 2, 1e-3) << "cells are squares";
}

TEST(RenderSvg, WideNamesOfColumnsStandUpright) {
  Panel panel;
  panel.field = Field2D{.x = {0, 1}, .y = {0}, .values = {0, 1}};
  panel.field->x_names = {"a", "b"};
  EXPECT_EQ(count(render_svg(one_panel(panel)), "rotate(-90"), 0U);
  panel.field->x_names = {"a", std::string(80, 'b')};
  EXPECT_EQ(count(render_svg(one_panel(panel)), "rotate(-90"), 2U);
}

TEST(RenderSvg, AFieldWithoutValuesNamesThePlaces) {
  Panel panel;
  panel.series = {{.label = "f", .method = "f", .x = {0, 1}, .y = {3, 4}}};
  panel.field = Field2D{.x_names = {"first", "second"}};
  const std::string svg = render_svg(one_panel(panel));
  EXPECT_EQ(count(svg, ">first</text>") + count(svg, ">second</text>"), 2U);
  EXPECT_EQ(count(svg, "<image"), 0U);
}

TEST(RenderSvg, RowsWithNamesHaveTheirHeight) {
  Panel panel;
  panel.field = Field2D{.x = {0}, .y = {0, 1}, .values = {0, 1}};
  panel.field->y_names = {"a", "b"};
  const std::string low = render_svg(one_panel(panel));
  panel.field->y.assign(60, 0);
  panel.field->values.assign(60, 1);
  panel.field->y_names.assign(60, "a");
  const std::string high = render_svg(one_panel(panel));
  const auto height = [](const std::string& svg) {
    return std::stod(svg.substr(svg.find("height=\"") + 8));
  };
  EXPECT_GT(height(high), height(low) + 400);
}

TEST(RenderSvg, FieldsMayShareAScale) {
  Panel panel;
  panel.field =
      Field2D{.x = {0, 1}, .y = {0}, .values = {0, 1}, .min = -1.0, .max = 3.0};
  const Pixels is = decoded(from_base64(render_svg(one_panel(panel))), 2, 1);
  EXPECT_EQ(is.rgba[0], color(kFieldColors / 4));
  EXPECT_EQ(is.rgba[1], color(kFieldColors / 2));
}

TEST(RenderSvg, ArrowsAreShaftsWithHeads) {
  Panel panel;
  panel.field = Field2D{.x = {0, 1}, .y = {0, 1}, .values = {1, 1, 1, 1}};
  panel.arrows =
      Arrows{.x = {0, 1, 1}, .y = {0, 1, 0}, .u = {1, 0, kNaN}, .v = {0, 2, 0}};
  const std::string svg = render_svg(one_panel(panel));
  EXPECT_EQ(xml_error(svg), "");
  const auto at = svg.find("class=\"arrow\"");
  ASSERT_NE(at, svg.npos);
  const std::string d = svg.substr(at, svg.find("/>", at) - at);
  EXPECT_EQ(count(d, "M"), 6U);  // of two; the third cannot be shown
  // The longest points straight up, over its length; the other is half of it,
  // to the right.
  EXPECT_EQ(count(d, "l0 -"), 1U);
  panel.arrows->u = panel.arrows->v = {0, 0, 0};
  EXPECT_EQ(xml_error(render_svg(one_panel(panel))), "");
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
  EXPECT_FALSE(figures[0].panels[0].series[0].style);
  const std::string svg = render_svg(figures[0]);
  EXPECT_EQ(count(svg, "class=\"l s3\""), 2U);  // legend and curve
  EXPECT_EQ(count(svg, "class=\"l s6\""), 3U);  // one method, one colour
}

}  // namespace
}  // namespace physinv
