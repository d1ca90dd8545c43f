#include "reports/vega_lite.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "reports/html_parts.h"
#include "reports/tables.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

Figure figure() {
  Panel curves{.title = "A", .x_label = "updates", .y_label = "loss"};
  curves.x_log = curves.y_log = true;
  curves.series = {{.label = "Adam",
                    .method = "adam",
                    .x = {0, 1, 2},
                    .y = {1, 0.5, 0.25},
                    .lo = {1, 0.4, 0.2},
                    .hi = {1, 0.6, 0.3}},
                   {.label = "HIG, \"half\"",
                    .method = "hig",
                    .x = {1, 2},
                    .y = {0.5, -1},
                    .line = false,
                    .markers = true}};
  Panel field{.title = "B", .x_label = "x", .y_label = "y"};
  field.field =
      Field2D{.x = {0, 1}, .y = {0, 1, 2}, .values = {1, 2, 3, 4, 5, 6}};
  field.arrows = Arrows{{0}, {0}, {3}, {4}, 1};
  return {.id = "f",
          .title = "F",
          .where = "Fig. 1",
          .panels = {curves, field, Panel{.title = "C"}},
          .note = "as it is"};
}

/// What every view of the specification has to have.
void expect_layer(const Json& layer) {
  ASSERT_TRUE(layer.contains("mark")) << layer.dump(1);
  ASSERT_TRUE(layer.at("data").at("values").is_array());
  std::set<std::string> fields;
  for (const Json& row : layer.at("data").at("values"))
    for (const auto& [key, value] : row.items()) fields.insert(key);
  const Json channels = layer.value("encoding", Json::object());
  for (const auto& [channel, encoding] : channels.items()) {
    if (encoding.contains("value")) continue;
    EXPECT_TRUE(fields.contains(encoding.at("field").get<std::string>()))
        << channel;
    if (channel == "x2" || channel == "y2") continue;
    EXPECT_TRUE(encoding.contains("type")) << channel;
    const Json scale = encoding.value("scale", Json::object());
    if (encoding.at("type") == "quantitative" && channel.size() == 1) {
      EXPECT_EQ(scale.at("nice"), false) << "room for decades without data";
      EXPECT_EQ(scale.contains("zero"), scale.at("type") == "linear")
          << "a warning for each logarithmic axis";
    }
    if (layer.at("mark").at("type") == "line") {
      EXPECT_EQ(layer.at("mark").at("strokeCap"), "round");
    }
    if (scale.contains("domain") && encoding.at("type") == "nominal") {
      EXPECT_EQ(scale.at("domain").size(), scale.at("range").size());
    }
  }
}

TEST(VegaLite, HasPanelsWithTheirData) {
  const Json spec = vega_lite(figure());
  EXPECT_EQ(spec.at("$schema"),
            "https://vega.github.io/schema/vega-lite/v5.json");
  EXPECT_EQ(spec.at("title"), "Fig. 1 · F");
  ASSERT_EQ(spec.at("concat").size(), 4U) << "with the legend";
  for (const Json& panel : spec.at("concat"))
    for (const Json& layer : panel.at("layer")) expect_layer(layer);
}

TEST(VegaLite, LeavesOutWhatALogAxisCannotShow) {
  const Json layers = vega_lite(figure()).at("concat").at(0).at("layer");
  ASSERT_EQ(layers.size(), 3U) << "band, lines, points";
  const Json& rows = layers.at(1).at("data").at("values");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows.at(0).at("x"), 1);
  EXPECT_EQ(rows.at(0).at("hi"), 0.6);
  EXPECT_EQ(rows.at(2).at("series"), "HIG, \"half\"");
  EXPECT_EQ(layers.at(1).at("encoding").at("y").at("scale").at("type"), "log");
  const Json& color = layers.at(1).at("encoding").at("color").at("scale");
  EXPECT_EQ(color.at("domain"), (Json{"Adam", "HIG, \"half\""}));
  EXPECT_EQ(color.at("range").at(0).get<std::string>().substr(0, 1), "#");
}

TEST(VegaLite, FieldsAreRectanglesAndArrowsRules) {
  const Json layers = vega_lite(figure()).at("concat").at(1).at("layer");
  ASSERT_EQ(layers.size(), 2U);
  EXPECT_EQ(layers.at(0).at("mark").at("type"), "rect");
  const Json& rows = layers.at(0).at("data").at("values");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows.at(1).at("value"), (Json{3.0, 4.0}));
  EXPECT_EQ(rows.at(0).at("x"), (Json{-0.5, 0.5}));
  EXPECT_EQ(rows.at(0).at("x2"), (Json{0.5, 1.5}));
  EXPECT_EQ(rows.at(2).at("y2"), 2.5);
  const Json& arrow = layers.at(1).at("data").at("values").at(0);
  EXPECT_DOUBLE_EQ(arrow.at("x2"), 0.6);
  EXPECT_DOUBLE_EQ(arrow.at("y2"), 0.8);
}

TEST(VegaLite, AFieldWithoutValuesNamesThePlaces) {
  Panel panel{.x_label = "solver", .y_label = "f"};
  panel.series = {{.label = "f", .method = "f", .x = {0, 1}, .y = {3, 4}}};
  panel.field = Field2D{.x_names = {"a's", "b"}};
  const Json layers = vega_lite({.id = "f", .title = "F", .panels = {panel}})
                          .at("concat")
                          .at(0)
                          .at("layer");
  for (const Json& layer : layers)
    EXPECT_NE(layer.at("mark").at("type"), "rect");
  const Json& axis = layers.at(0).at("encoding").at("x").at("axis");
  EXPECT_EQ(axis.at("values"), (Json{0, 1}));
  EXPECT_EQ(axis.at("labelExpr"), "[\"a's\",\"b\"][datum.value]");
}

TEST(VegaLite, EveryHueHasAShape) {
  Figure f = figure();
  f.panels[0].series[1].style =
      PlotStyle{Hue::indigo, static_cast<Marker>(Hue::indigo)};
  const Json shapes = vega_lite(f)
                          .at("concat")
                          .at(0)
                          .at("layer")
                          .at(2)
                          .at("encoding")
                          .at("shape")
                          .at("scale")
                          .at("range");
  ASSERT_EQ(shapes.size(), 2U);
  EXPECT_EQ(shapes.at(1), "cross");
}

TEST(VegaLite, EntriesOfOneLabelAreToldApart) {
  Figure f = figure();
  f.panels[0].series[1].label = "Adam";
  const Json names = vega_lite(f)
                         .at("concat")
                         .at(0)
                         .at("layer")
                         .at(0)
                         .at("encoding")
                         .at("color")
                         .at("scale")
                         .at("domain");
  EXPECT_EQ(names, (Json{"Adam", "Adam (hig)"}));
}

TEST(VegaLite, OneLegendShowsWhatTellsEntriesApart) {
  Figure f = figure();
  f.panels[0].series[1] = f.panels[0].series[0];
  f.panels[0].series[1].label = "paper";
  f.panels[0].series[1].dashed = true;
  f.panels[0].series[1].markers = true;
  const Json spec = vega_lite(f);
  const Json& legend = spec.at("concat").back();
  EXPECT_EQ(legend.at("view").at("stroke"), nullptr);
  ASSERT_EQ(legend.at("layer").size(), 3U) << "lines, markers, names";
  const Json& rows = legend.at("layer").at(0).at("data").at("values");
  EXPECT_EQ(rows,
            (Json{{{"series", "Adam"}, {"line", true}, {"mark", "none"}},
                  {{"series", "paper"}, {"line", true}, {"mark", "hollow"}}}));
  const Json& dashes = legend.at("layer").at(0).at("encoding").at("strokeDash");
  EXPECT_NE(dashes.at("scale").at("range").at(0),
            dashes.at("scale").at("range").at(1));
  int channels = 0;
  for (const Json& panel : spec.at("concat"))
    for (const Json& layer : panel.at("layer")) {
      const Json encodings = layer.value("encoding", Json::object());
      for (const char* name : {"color", "shape", "strokeDash"}) {
        if (!encodings.contains(name)) continue;
        EXPECT_EQ(encodings.at(name).at("legend"), nullptr) << name;
        ++channels;
      }
    }
  EXPECT_GT(channels, 6);
  f.panels[0].series.clear();
  EXPECT_EQ(vega_lite(f).at("concat").size(), 3U) << "none without entries";
}

TEST(VegaLite, PlacesThatALogAxisLacksAreNames) {
  Figure f = figure();
  Panel& panel = f.panels[1];
  panel.arrows.reset();
  panel.x_log = panel.y_log = true;
  panel.field =
      Field2D{.x = {0, 1}, .y = {1, 2, 4}, .values = {1, 2, 3, 0, 5, 6}};
  panel.field->log_scale = true;
  const Json layer = vega_lite(f).at("concat").at(1).at("layer").at(0);
  const Json& x = layer.at("encoding").at("x");
  EXPECT_EQ(x.at("type"), "ordinal");
  EXPECT_EQ(x.at("scale").at("domain"), (Json{"0", "1"}));
  const Json& y = layer.at("encoding").at("y");
  EXPECT_EQ(y.at("scale").at("type"), "log");
  EXPECT_EQ(y.at("scale").at("domain").size(), 2U);
  const Json& rows = layer.at("data").at("values");
  EXPECT_EQ(rows.at(0).at("x"), (Json{"0", "1"}));
  EXPECT_EQ(rows.at(1).at("x"), Json::array({"0"})) << "0 is not shown";
  EXPECT_EQ(rows.at(1).at("value"), Json::array({3.0}));
}

TEST(VegaLite, LimitsOfALogAxisArePositive) {
  Figure f = figure();
  f.panels[0].y_min = 0;
  f.panels[0].y_max = 1;
  const auto scale = [&] {
    return vega_lite(f)
        .at("concat")
        .at(0)
        .at("layer")
        .at(1)
        .at("encoding")
        .at("y")
        .at("scale");
  };
  EXPECT_FALSE(scale().contains("domain")) << scale();
  f.panels[0].y_min = 0.1;
  EXPECT_EQ(scale().at("domain"), (Json{0.1, 1.0}));
}

TEST(VegaLite, PlacesHaveTheirLimitsAndShape) {
  Figure f = figure();
  Panel& p = f.panels[0];
  p.x_log = p.y_log = false, p.field.reset();
  p.x_min = 0, p.x_max = 2, p.y_min = 0, p.y_max = 1, p.space = true;
  const Json panel = vega_lite(f).at("concat").at(0);
  EXPECT_EQ(panel.at("width").get<int>(), 2 * panel.at("height").get<int>());
  const Json& encoding = panel.at("layer").at(0).at("encoding");
  EXPECT_EQ(encoding.at("x").at("scale").at("domain"), (Json{0.0, 2.0}));
}

TEST(FigureCsv, HasALineForEachPointAndCell) {
  const std::string csv = to_csv(figure());
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "panel,series,x,y,from,to,value");
  EXPECT_NE(csv.find("A,Adam,1,0.5,0.4,0.6,\n"), csv.npos) << csv;
  EXPECT_NE(csv.find("A,\"HIG, \"\"half\"\"\",2,-1,,,\n"), csv.npos) << csv;
  EXPECT_NE(csv.find("B,,1,2,,,6\n"), csv.npos) << csv;
}

TEST(SectionHtml, ClaimsAndFiguresLeadToEachOther) {
  Section section{.experiment = "jpo/toy", .title = "Toy"};
  section.figures = {figure()};
  section.tables = {{.id = "t", .title = "T", .where = "Table 2"}};
  section.claims = {{.id = "P1", .says = "so", .where = "Sec. 1, Fig. 1b"},
                    {.id = "P2", .says = "so", .where = "Sec. 4"}};
  const Anchors anchors = anchors_of({section}).front();
  const std::string page =
      section_html(section, anchors, Palette(), {"", "./bench x"});
  EXPECT_NE(page.find(" · here: <a href=\"#jpo-toy-f\">Fig. 1</a>"), page.npos)
      << page;
  EXPECT_NE(page.find("Statements: <a href=\"#jpo-toy-P1\">– P1</a></p>"),
            page.npos);
  EXPECT_EQ(page.find("#jpo-toy-P2\">– P2"), page.npos);
  for (const char* file :
       {"figures/f.svg", "figures/f.csv", "figures/f.vl.json", "tables/t.csv"})
    EXPECT_NE(page.find("href=\"" + std::string(file)), page.npos) << file;
  EXPECT_NE(page.find("<code>./bench x</code>"), page.npos);
}

}  // namespace
}  // namespace physinv
