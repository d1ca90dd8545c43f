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

TEST(TrainingReport, FieldsAreTheTruthWhatIsSeenAndEachAnswer) {
  std::vector<double> shown;
  const auto fields = [&](const Results& results) {
    return answered_fields(results,
                           "toy",
                           {{"b", "B"}, {"c", "C"}, {"a", "A"}},
                           "Fig. 9",
                           [&](std::string title, const Vector<double>& field) {
                             shown.push_back(field(0));
                             return Panel{.title = std::move(title)};
                           });
  };
  const Figure figure = fields(Results({answered("a"), answered("b")}));
  std::vector<std::string> titles;
  for (const Panel& p : figure.panels) titles.push_back(p.title);
  EXPECT_EQ(titles,
            (std::vector<std::string>{"truth x*", "observed y", "B", "A"}));
  EXPECT_EQ(shown, (std::vector<double>{0.25, 7, 1, 1}));
  EXPECT_EQ(figure.source, "Fig. 9");
  EXPECT_TRUE(fields(Results{}).panels.empty());
}

}  // namespace
}  // namespace physinv
