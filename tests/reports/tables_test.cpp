#include "reports/tables.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "reports/text.h"

namespace physinv {
namespace {

Table sample() {
  return {.id = "table4",
          .title = "Better, or equal",
          .where = "Table 4",
          .unit = "%",
          .digits = 1,
          .corner = "equality",
          .columns = {"JPO, better", "NA \"x\" a|b"},
          .rows = {{"strict",
                    {{.ours = 44.25, .spread = 2, .paper = 44.3},
                     {.text = "not run"}}},
                   {"tol",
                    {{.ours = std::numeric_limits<double>::quiet_NaN()},
                     {.ours = 1e-9}}}},
          .note = "Mean over seeds."};
}

TEST(Tables, JsonHasNullsWhereNothingIs) {
  const auto json = to_json(sample());
  const auto& cell = json["rows"][0]["cells"][0];
  EXPECT_EQ(cell["ours"], 44.25);
  EXPECT_EQ(cell["paper"], 44.3);
  EXPECT_TRUE(cell["paper_spread"].is_null());
  EXPECT_FALSE(cell.contains("text"));
  EXPECT_TRUE(json["rows"][0]["cells"][1]["ours"].is_null());
  EXPECT_EQ(json["rows"][0]["cells"][1]["text"], "not run");
  EXPECT_TRUE(json["rows"][1]["cells"][0]["ours"].is_null());  // NaN
}

TEST(Tables, CsvQuotes) {
  EXPECT_EQ(to_csv(sample()),
            "equality,\"JPO, better [%]\",\"JPO, better spread [%]\","
            "\"JPO, better paper [%]\","
            "\"NA \"\"x\"\" a|b [%]\",\"NA \"\"x\"\" a|b note\"\n"
            "strict,44.25,2,44.3,,not run\n"
            "tol,,,,1e-09,\n");
}

TEST(Tables, CsvHasKeysInColumnsOfTheirOwn) {
  const Table table{.id = "t",
                    .corner = "n, method",
                    .columns = {"loss", "end"},
                    .rows = {{"8 BFGS",
                              {{.ours = 1.0 / 3, .text = "0.3"}, {.text = "–"}},
                              {"8", "BFGS"}},
                             {"16 JPO",
                              {{.ours = 1e-3, .text = "1 (at 2)", .of = "at 2"},
                               {.text = "yes"}},
                              {"16", "JPO"}}},
                    .keys = {"n", "method"}};
  EXPECT_EQ(to_csv(table),
            "n,method,loss,loss of,end\n"
            "8,BFGS,0.3333333333333333,,\n"
            "16,JPO,0.001,at 2,yes\n");
}

TEST(Tables, CsvHasARowForEachValueOfColumns) {
  const Table table{
      .id = "t",
      .unit = "s",
      .corner = "n",
      .columns = {"A better", "A equal", "B better", "B equal"},
      .rows = {{"8", {{.ours = 1}, {.ours = 2}, {.text = "not run"}}}},
      .across = Across{.key = "method",
                       .values = {"A", "B"},
                       .quantities = {"better", "equal"}}};
  EXPECT_EQ(to_csv(table),
            "n,method,better [s],better note,equal [s]\n"
            "8,A,1,,2\n"
            "8,B,,not run,\n");
}

TEST(Tables, MarkdownIsAligned) {
  const std::string text = to_markdown(sample());
  EXPECT_EQ(text,
            "**Table 4 · Better, or equal [%]**\n\n"
            "| equality | JPO, better | paper | NA \"x\" a\\|b |\n"
            "| -------- | ----------: | ----: | ----------: |\n"
            "| strict   |  44.2 ± 2.0 |  44.3 |     not run |\n"
            "| tol      |           – |       |     1.0e-09 |\n"
            "\nMean over seeds.\n");
}

TEST(Tables, TextKeepsTheWidth) {
  for (const std::size_t width : {24U, 40U, 80U}) {
    std::istringstream lines(render_text(sample(), width));
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(display_width(line), std::max<std::size_t>(width, 30)) << line;
    }
  }
  EXPECT_EQ(render_text(sample(), 80),
            "Table 4 · Better, or equal [%]\n"
            "equality  JPO, better  paper  NA \"x\" a|b\n"
            "────────────────────────────────────────\n"
            "strict     44.2 ± 2.0   44.3     not run\n"
            "tol                 –            1.0e-09\n"
            "Mean over seeds.\n");
}

TEST(Tables, ShortRowsAndNoColumns) {
  const Table table{.id = "t", .columns = {"a"}, .rows = {{"r", {}}}};
  EXPECT_NE(to_markdown(table).find("–"), std::string::npos);
  EXPECT_EQ(render_text({.id = "t", .title = "T"}, 80), "T\n");
  EXPECT_EQ(to_csv({.id = "t", .corner = "c"}), "c\n");
}

TEST(Text, NumbersForReaders) {
  EXPECT_EQ(show_number(0, 1), "0.0");
  EXPECT_EQ(show_number(-0.0, 1), "0.0");
  EXPECT_EQ(show_number(0.04, 1), "4.0e-02");
  EXPECT_EQ(show_number(3e7, 1), "3.0e+07");
  EXPECT_EQ(show_number(std::numeric_limits<double>::infinity(), 1), "–");
}

}  // namespace
}  // namespace physinv
