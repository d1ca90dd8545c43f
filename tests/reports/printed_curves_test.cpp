#include "reports/printed_curves.h"

#include <gtest/gtest.h>

#include "suite/store/errors.h"

namespace physinv {
namespace {

std::vector<PrintedCurve> curves_of(const std::string& list) {
  return printed_curves("{\"curves\": [" + list + "]}", "paper.json");
}

std::string curve(const std::string& more) {
  return R"({"experiment": "jpo/toy", "figure": "fig1", "method": "jpo",
             "label": "JPO, paper", "where": "Table 4", )" +
         more + "}";
}

Section section() {
  const Series ours{.label = "JPO",
                    .method = "jpo",
                    .x = {1, 10},
                    .y = {0.5, 0.25},
                    .style = PlotStyle{Hue::orange, Marker::square}};
  Section s{.experiment = "jpo/toy"};
  s.figures = {{.id = "fig1",
                .panels = {{.title = "a", .series = {ours}},
                           {.title = "b", .series = {ours}},
                           {.title = "c",
                            .series = {{.label = "JPO", .method = "jpo"}}}},
                .note = "Ours."},
               {.id = "fig2", .panels = {{.series = {ours}}}}};
  return s;
}

TEST(PrintedCurves, ALevelIsAsLongAsOurs) {
  Section s = section();
  draw_printed(curves_of(curve(R"("level": [0.2, 0.3, 0.4])")), s);
  ASSERT_EQ(s.figures[0].panels[0].series.size(), 2U);
  const Series& printed = s.figures[0].panels[0].series[1];
  EXPECT_EQ(printed.x, (std::vector<double>{1, 10}));
  EXPECT_EQ(printed.y, (std::vector<double>{0.3, 0.3}));
  EXPECT_EQ(printed.lo, (std::vector<double>{0.2, 0.2}));
  EXPECT_EQ(printed.hi, (std::vector<double>{0.4, 0.4}));
  EXPECT_TRUE(printed.dashed && printed.line && !printed.markers);
  EXPECT_EQ(printed.style->hue, Hue::orange);
  EXPECT_EQ(s.figures[0].note,
            "Ours. The paper's, with the error of reading: Table 4.");
  EXPECT_EQ(s.figures[0].panels[2].series.size(), 1U) << "ours was not run";
  EXPECT_EQ(s.figures[1].panels[0].series.size(), 1U) << "another figure";
  EXPECT_EQ(s.figures[1].note, "");
}

TEST(PrintedCurves, PointsAndSpansGoToTheirPanels) {
  Section s = section();
  draw_printed(
      curves_of(curve(R"("panels": ["b"], "points": [[2, 0.1, 0.2, 0.3]])") +
                "," + curve(R"("panels": ["a"], "span": [3, 4])")),
      s);
  const Series& points = s.figures[0].panels[1].series.at(1);
  EXPECT_TRUE(points.markers);
  EXPECT_EQ(points.x, std::vector<double>{2});
  EXPECT_EQ(points.hi, std::vector<double>{0.3});
  const Series& span = s.figures[0].panels[0].series.at(1);
  EXPECT_EQ(span.x, (std::vector<double>{3, 3, 4, 4}));
  EXPECT_EQ(span.y, (std::vector<double>{0.25, 0.5, 0.5, 0.25}));
  EXPECT_TRUE(span.lo.empty());
}

TEST(PrintedCurves, WhatIsNoneIsRefused) {
  EXPECT_TRUE(printed_curves("{}", "paper.json").empty());
  for (const char* wrong : {R"("level": [0.4, 0.3, 0.2])",
                            R"("level": [1, 2])",
                            R"("level": ["1", 2, 3])",
                            R"("points": [[1, 2, 3]])",
                            R"("span": 3)",
                            R"("nothing": 1)"})
    try {
      curves_of(curve(wrong));
      FAIL() << wrong;
    } catch (const StoreError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("paper.json is damaged: ", 0),
                0U)
          << error.what();
    }
  EXPECT_THROW(curves_of("{}"), StoreError);
  EXPECT_THROW(printed_curves("[", "paper.json"), StoreError);
}

}  // namespace
}  // namespace physinv
