#include "reports/report.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "reports/text.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

std::vector<Section> sample() {
  Panel panel{.title = "p"};
  panel.series.push_back({.label = "JPO",
                          .method = "jpo",
                          .x = {1, 2},
                          .y = {1, std::numeric_limits<double>::quiet_NaN()}});
  return {
      {.experiment = "jpo/toy",
       .title = "Toy",
       .paper = "someone2020",
       .tables = {{.id = "table1", .title = "T", .columns = {"a"}}},
       .figures =
           {{.id = "fig1", .title = "F", .where = "Fig. 1", .panels = {panel}}},
       .claims = {{.id = "R1",
                   .says = "a | b",
                   .from = "quick",
                   .gates = true,
                   .verdict = Verdict::reproduced,
                   .evidence = "0.98",
                   .origin = Origin::paper,
                   .where = "Fig. 1"},
                  {.id = "R2", .says = "c", .from = "paper"}}}};
}

class ReportTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::path(testing::TempDir()) /
           (std::string("physinv_report_") + test->name());
    fs::remove_all(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }
  fs::path dir_;
};

TEST_F(ReportTest, WritesEveryFormat) {
  const auto files = write_report(dir_, sample(), {{"revision", "abc"}});
  EXPECT_EQ(files.size(), 10U);
  for (const char* name : {"jpo-toy/tables/table1.json",
                           "jpo-toy/tables/table1.csv",
                           "jpo-toy/tables/table1.md",
                           "jpo-toy/figures/fig1.json",
                           "jpo-toy/figures/fig1.csv",
                           "jpo-toy/figures/fig1.vl.json",
                           "jpo-toy/figures/fig1.svg",
                           "claims.json",
                           "report.md",
                           "index.html"}) {
    EXPECT_TRUE(fs::exists(dir_ / name)) << name;
  }
  std::size_t found = 0;
  for (const auto& e : fs::recursive_directory_iterator(dir_)) {
    found += e.is_regular_file();
  }
  EXPECT_EQ(found, files.size());  // nothing half-written is left
}

TEST_F(ReportTest, AgainTheSameBytes) {
  const auto files = write_report(dir_, sample(), {{"revision", "abc"}});
  std::vector<std::string> before;
  for (const auto& f : files) before.push_back(read(f));
  write_report(dir_, sample(), {{"revision", "abc"}});
  for (std::size_t i = 0; i < files.size(); ++i) {
    EXPECT_EQ(read(files[i]), before[i]) << files[i];
  }
}

TEST_F(ReportTest, ClaimsAndFiguresAreData) {
  write_report(dir_, sample(), {{"revision", "abc"}});
  const auto claims = nlohmann::json::parse(read(dir_ / "claims.json"));
  EXPECT_EQ(claims["provenance"]["revision"], "abc");
  EXPECT_EQ(claims["sections"][0]["claims"][0]["verdict"], "reproduced");
  EXPECT_EQ(claims["sections"][0]["claims"][1]["verdict"], "not judged");
  const auto fig =
      nlohmann::json::parse(read(dir_ / "jpo-toy/figures/fig1.json"));
  EXPECT_TRUE(fig["panels"][0]["series"][0]["y"][1].is_null());
}

TEST(Report, OverviewNamesVerdictsAndLinks) {
  const std::string text = report_markdown(sample(), {{"revision", "abc"}});
  EXPECT_NE(
      text.find("claims of the papers 1 reproduced, 0 not reproduced, 0 not "
                "judged, 0 reported; regression checks 0 reproduced, 0 "
                "not reproduced, 1 not judged"),
      text.npos);
  EXPECT_NE(
      text.find(
          "| R1 | a \\| b (Fig. 1) | ✓ reproduced | quick | yes | 0.98 |"),
      text.npos);
  EXPECT_NE(text.find("(jpo-toy/figures/fig1.svg)"), text.npos);
  EXPECT_NE(text.find("- revision: abc"), text.npos);
}

TEST(Report, ClaimsForATerminal) {
  const std::string text = render_claims_text(sample(), 60);
  EXPECT_NE(text.find("R1   reproduced"), text.npos);
  EXPECT_NE(text.find("R2   not judged"), text.npos);
  EXPECT_NE(render_claims_text(sample(), 200).find("a | b (Fig. 1) — 0.98"),
            text.npos);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(display_width(line), 60U) << line;
  }
}

}  // namespace
}  // namespace physinv
