#include <gtest/gtest.h>

#include <algorithm>

#include "problems/noisy_absolute/noisy_absolute.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

const JpoReportOptions kOptions{.table3_sizes = {4, 8}};

/// Of an experiment whose network has one matrix and one bias.
Section section_of(const JpoReportOptions& options, const Evidence& evidence) {
  if (registry().find(evidence.experiment) == nullptr)
    registry().add(Experiment{
        .name = evidence.experiment,
        .title = "Toy",
        .problem = problems::noisy_absolute(),
        .setting = {.predictor = {{Field::observations}, nn::mlp({})}}});
  return jpo_section(options, evidence);
}

const Table& table(const Section& s, const std::string& id) {
  return *std::find_if(s.tables.begin(), s.tables.end(), [&](const Table& t) {
    return t.id == id;
  });
}

const Figure& figure(const Section& s, const std::string& id) {
  return *std::find_if(s.figures.begin(),
                       s.figures.end(),
                       [&](const Figure& f) { return f.id == id; });
}

Results some_results() {
  StageRecord fit = stage_of("fit", {1e-3, 0.5}, {1, 1});
  fit.arrays["weight_change"] = Batch<double>::Constant(2, 1, 0.125);
  StageRecord crowded = stage_of("refine", {1e-9, 0.5});
  crowded.crowded = true;
  crowded.clocks.solve = {2, 3.5};  // of several threads
  fit.crowded = true;
  fit.clocks.solve = {20, 1.5};
  return Results(
      {case_of(
           "bfgs", 2, 0, {"solve"}, {stage_of("solve", {0.5, 0.5}, {1, 1})}),
       case_of(
           "bfgs", 2, 1, {"solve"}, {stage_of("solve", {0.5, 0.0}, {1, 1})}),
       case_of("jpo", 2, 0, {"fit", "refine"}, {fit, crowded})});
}

TEST(JpoReport, NothingRunYet) {
  const Results results;
  const Section s = section_of(kOptions, {results, {}, "toy"});
  EXPECT_EQ(s.tables.size(), 5U);
  EXPECT_EQ(s.figures.size(), 5U);
  EXPECT_EQ(table(s, "table4").rows[0].cells[0].text, "not run");
  EXPECT_FALSE(table(s, "table4").rows[0].cells[0].ours);
  EXPECT_TRUE(figure(s, "fig13").panels.empty());
}

TEST(JpoReport, TablesHoldMeansAndSpreads) {
  const Results results = some_results();
  const Section s = section_of(kOptions, {results, {}, "toy"});
  const Table& seconds = table(s, "table2");
  ASSERT_EQ(seconds.columns.size(), 8U);
  EXPECT_EQ(*seconds.rows[0].cells[0].ours, 2);
  EXPECT_EQ(*seconds.rows[0].cells[0].spread, 0);
  EXPECT_EQ(seconds.unit, "CPU s");
  EXPECT_EQ(*seconds.rows[0].cells[1].ours, 1.5);
  EXPECT_NE(seconds.note.find("2 of 4 stages shared their cores (crowded)"),
            std::string::npos)
      << seconds.note;
  EXPECT_EQ(seconds.rows[0].cells[2].text, "crowded");
  EXPECT_FALSE(seconds.rows[0].cells[2].ours);
  EXPECT_EQ(seconds.rows[0].cells[3].text, "not run");
  const Table& refined = table(s, "table5");
  ASSERT_EQ(refined.rows.size(), 2U);
  EXPECT_EQ(*refined.rows[0].cells[0].ours, 50);
  EXPECT_EQ(*refined.rows[0].cells[1].ours, 50);
  EXPECT_FALSE(refined.rows[0].cells[0].spread);
  EXPECT_EQ(table(s, "results").rows.size(), 7U);
  EXPECT_EQ(table(s, "table3").rows[0].cells[1].text, "not run");
}

TEST(JpoReport, AMethodInPythonHasARowAndCurves) {
  auto cases = some_results().cases();
  StageRecord solve = stage_of("solve", {0, 0}, {1, 1});
  solve.options = {{"algorithm", "python"}};
  cases.push_back(case_of("mine", 2, 0, {"solve"}, {solve}));
  const Results results(cases);
  const Section s = section_of(kOptions, {results, {}, "toy"});
  const Table& rows = table(s, "results");
  ASSERT_EQ(rows.rows.size(), 8U);
  EXPECT_EQ(rows.rows.back().label, "2 mine");
  EXPECT_EQ(rows.rows.back().cells[0].ours, 1) << "solved";
  EXPECT_EQ(rows.rows.back().cells[2].ours, 1) << "better than BFGS";
  for (const char* id : {"fig4b", "fig11", "fig12", "fig13"}) {
    const auto& all = figure(s, id).panels.at(0).series;
    const auto mine = std::ranges::find(all, "mine", &Series::label);
    ASSERT_NE(mine, all.end()) << id;
    EXPECT_FALSE(mine->x.empty()) << id;
  }
}

TEST(JpoReport, NothingIsSaidOfTheRunsThatDidNotFail) {
  const auto with = [](std::size_t failing) {
    auto cases = some_results().cases();
    cases[failing].stages.back().stop = Stop::failed;
    const Results results(cases);
    return section_of(kOptions, {results, {}, "toy"});
  };
  const Section bfgs = with(1), refine = with(2);
  EXPECT_EQ(table(bfgs, "table2").rows[0].cells[0].text, "1 of 2 runs failed");
  EXPECT_EQ(table(bfgs, "table5").rows[0].cells[0].text, "1 of 2 runs failed")
      << "beside BFGS";
  EXPECT_EQ(table(refine, "table5").rows[0].cells[0].text,
            "1 of 1 runs failed");
  EXPECT_EQ(table(refine, "table3").rows[0].cells[0].text, "not run");
}

TEST(JpoReport, PaperNumbersStandBeside) {
  JpoReportOptions options = kOptions;
  options.table3_sizes = {4};
  const Published published(PHYSINV_SOURCE_DIR "/reports/published");
  const Results results;
  const Section s = section_of(options, {results, published, "jpo/billiards"});
  for (const char* id : {"table2", "table3", "table4", "table5"}) {
    for (const Cell& cell : table(s, id).rows[0].cells) {
      EXPECT_TRUE(cell.paper) << id;
    }
  }
  EXPECT_EQ(*table(s, "table2").rows[0].cells[0].paper, 21.5);
  EXPECT_EQ(*table(s, "table4").rows[0].cells[0].paper, 44.3);
}

TEST(JpoReport, FiguresHoldWhatIsThere) {
  const Results results = some_results();
  const Section s = section_of(kOptions, {results, {}, "toy"});
  const Panel& curves = figure(s, "fig12").panels.at(0);
  const Series& bfgs = curves.series.at(0);
  EXPECT_EQ(bfgs.x, (std::vector<double>{1, 6}));  // iteration + 1
  EXPECT_EQ(bfgs.y, (std::vector<double>{1, 0.375}));
  EXPECT_GT(bfgs.hi[1], bfgs.y[1]);
  EXPECT_TRUE(curves.series.at(2).x.empty());  // supervised is not run
  const Figure& ways = figure(s, "fig13");
  ASSERT_EQ(ways.panels.size(), 2U);
  EXPECT_EQ(ways.panels[0].series.back().method, "truth");
  EXPECT_EQ(ways.panels[0].series.back().x, std::vector<double>{0.25});
  const Figure& change = figure(s, "fig14");
  EXPECT_EQ(change.panels.at(1).series.at(0).y, std::vector<double>{0.125});
  const Figure& fraction = figure(s, "fig4b");
  EXPECT_EQ(fraction.panels[0].series.at(1).y, std::vector<double>{0.75});
}

}  // namespace
}  // namespace physinv
