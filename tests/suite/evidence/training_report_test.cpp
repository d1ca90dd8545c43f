#include "suite/evidence/training_report.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

/// An example with x* = 0.25 and y = 7, of which the method says 1.
CaseRecord answered(const char* method) {
  CaseRecord c = trained_case(method, 0, {2, 1});
  c.data.y = Batch<double>::Constant(2, 4, 7);
  return c;
}

TEST(TrainingReport, FieldsAreTheTruthWhatIsSeenAndEachAnswerOfEachExample) {
  std::vector<double> shown;
  const auto fields = [&](const Results& results, Index examples) {
    shown.clear();
    return answered_fields(
        {results, {}, "toy"},
        {{"b", "B"}, {"c", "C"}, {"a", "A"}, {"b", "B, batch 8"}},
        {.where = "Fig. 9",
         .examples = examples,
         .picture =
             [&](std::string title, const Vector<double>& field) {
               shown.push_back(field(0));
               return Panel{.title = std::move(title)};
             },
         .observe = [](const Answered& a) -> Vector<double> {
           return 3 * a.x;
         }});
  };
  const Results both({answered("a"), answered("b")});
  const Figure figure = fields(both, 1);
  std::vector<std::string> titles;
  for (const Panel& p : figure.panels) titles.push_back(p.title);
  EXPECT_EQ(titles,
            (std::vector<std::string>{
                "observed y*", "truth x*", "B, y", "B, x", "A, y", "A, x"}));
  EXPECT_EQ(shown, (std::vector<double>{7, 0.25, 3, 1, 3, 1}));
  EXPECT_TRUE(figure.picture);
  EXPECT_EQ(figure.columns % 2, 0) << "pairs stay together";
  EXPECT_EQ(figure.where, "Fig. 9");
  EXPECT_EQ(fields(both, 2).panels.size(), 6U) << "one example is recorded";
  EXPECT_TRUE(fields(Results{}, 1).panels.empty());
}

TEST(TrainingReport, FailedAndDivergedRunsAreInTheTable) {
  std::vector<CaseRecord> cases;
  for (const std::uint64_t seed : {0, 1, 2}) {
    for (const char* method : {"failed", "diverged", "good"})
      cases.push_back(trained_case(method, seed, {2, 1}));
    if (seed > 0) cases[3 * seed + 1].stages[0].stop = Stop::diverged;
  }
  cases[0].stages[0] = {.stage = "fit", .stop = Stop::failed};
  const Results results(cases);
  const Evidence evidence{results, {}, "toy"};
  const std::vector<MethodLine> lines = {
      {"failed", "F"}, {"diverged", "D"}, {"good", "G"}};
  const Table table = loss_table(evidence, lines);
  ASSERT_EQ(table.rows.size(), 3U);
  for (const Cell& cell : table.rows[0].cells)
    EXPECT_EQ(cell.text, "1 of 3 runs failed");
  EXPECT_EQ(table.rows[1].cells[1].text, "not finite") << "median of 3, 2 lost";
  EXPECT_EQ(table.rows[1].cells[2].ours, 1) << "the lowest";
  EXPECT_EQ(table.rows[1].cells[4].text, "2/3");
  EXPECT_EQ(table.rows[2].cells[1].ours, 1);
  Section section;
  LearningCurves(evidence, section).losses(lines, "f", "F", "Fig. 1");
  ASSERT_EQ(section.figures.size(), 1U);
  EXPECT_TRUE(
      section.figures[0].note.ends_with(" Not drawn: F 1 of 3 runs failed."))
      << section.figures[0].note;
}

TEST(TrainingReport, AMethodInPythonHasARowAndACurve) {
  StageRecord solve = stage_of("solve", {1, 3}, {8, 4});
  solve.options = {{"algorithm", "python"}};
  solve.curve.iteration = {1, 5}, solve.curve.seconds = {1, 5};
  const Results results({trained_case("a", 0, {4, 2, 1}),
                         case_of("mine", 4, 0, {"solve"}, {solve})});
  const Evidence evidence{results, {}, "toy"};
  const Table table = loss_table(evidence, {{"a", "A"}});
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[1].label, "mine");
  EXPECT_EQ(table.rows[1].cells[1].ours, 2) << "mean of its examples";
  Section section;
  LearningCurves curves(evidence, section);
  for (const char* id : {"f", "g"})
    curves.losses({{"a", "A"}}, id, "F", "Fig. 1");
  ASSERT_EQ(section.figures[0].panels[0].series.size(), 2U);
  EXPECT_EQ(section.figures[0].panels[0].series[1].y,
            (std::vector<double>{6, 2}));
  EXPECT_EQ(section.figures[1].panels[0].series.size(), 1U)
      << "in the first figure alone";
}

TEST(TrainingReport, AnswersAreOfTheExampleThatIsAskedFor) {
  CaseRecord two = answered("a");
  two.stages.back().x = Batch<double>::Ones(2, 2);
  two.stages.back().x.col(1) *= 5;
  two.data.x.col(1) *= 2;
  const Results results({two});
  const auto second = answer_of({results, {}, "toy"}, "a", 1);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->x(0), 5);
  EXPECT_EQ(second->truth(0), 0.5);
  EXPECT_FALSE(answer_of({results, {}, "toy"}, "a", 2));
}

}  // namespace
}  // namespace physinv
