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
        {{"b", "B"}, {"c", "C"}, {"a", "A"}},
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
                "observed y*", "B, y", "A, y", "truth x*", "B, x", "A, x"}));
  EXPECT_EQ(shown, (std::vector<double>{7, 0.25, 3, 1, 3, 1}));
  EXPECT_EQ(figure.columns, 3);
  EXPECT_EQ(figure.where, "Fig. 9");
  EXPECT_EQ(fields(both, 2).panels.size(), 6U) << "one example is recorded";
  EXPECT_TRUE(fields(Results{}, 1).panels.empty());
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
