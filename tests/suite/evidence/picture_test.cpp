#include "suite/evidence/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

/// Four problems y = 0, 1, 2, 3 of which the method says x = `first` + k.
CaseRecord solved(const char* method, double first) {
  CaseRecord c =
      case_of(method, 4, 0, {"solve"}, {stage_of("solve", {1, 1, 1, 1})});
  c.data.hash = "same";
  c.data.y = Eigen::RowVector4d(0, 1, 2, 3);
  c.data.given = c.data.y.array() + 10;
  c.stages[0].x.row(0) = c.data.y.array() + first;
  return c;
}

const std::vector<PicturedMethod> kTwo = {{"A", {"a"}}, {"B", {"b"}}};

/// Titles "<who> <x>", a panel each.
PictureOptions drawn() {
  return {.title = "T",
          .note = "More.",
          .draw = [](const FoundBy& found, const Pictured& problem) {
            return Panel{
                .title = found.who + " " + std::to_string(int(found.x(0))),
                .field = Field2D{
                    .x = {0}, .y = {0}, .values = {found.x(0) + problem.y(0)}}};
          }};
}

std::vector<std::string> titles(const Figure& figure) {
  std::vector<std::string> all;
  for (const Panel& p : figure.panels) all.push_back(p.title);
  return all;
}

TEST(Picture, ShowsTruthFirstGuessAndEachMethodWithOneScale) {
  const Results results({solved("b", 7), solved("a", 5)});
  const Figure figure = picture(
      drawn(), pictured({results, {}, "toy"}, kTwo, Eigen::Vector2d(3, 3)));
  EXPECT_TRUE(figure.picture);
  EXPECT_EQ(titles(figure),
            (std::vector<std::string>{"truth 0", "start 3", "A 5", "B 7"}));
  for (const Panel& p : figure.panels) {
    EXPECT_EQ(p.field->min, 0.25);
    EXPECT_EQ(p.field->max, 7);
  }
  EXPECT_EQ(figure.note, "Problem 1 of 4, seed 0. More.");
}

TEST(Picture, TakesTheFirstProblemThatIsWorthShowing) {
  const Results results({solved("a", 5)});
  PictureOptions options = drawn();
  options.worth = {[](const Vector<double>& given, const Vector<double>& y) {
                     EXPECT_EQ(given(0), y(0) + 10);
                     return y(0) >= 2;
                   },
                   "that are large"};
  const auto shown = pictured({results, {}, "toy"}, kTwo, {}, options.worth);
  const Figure figure = picture(options, shown);
  EXPECT_EQ(titles(figure), (std::vector<std::string>{"truth 0", "A 7"}));
  EXPECT_EQ(figure.note,
            "Problem 3 of 4, seed 0, the first of 2 that are large. More.");
  options.worth.holds = [](const auto&, const auto&) { return false; };
  EXPECT_EQ(pictured({results, {}, "toy"}, kTwo, {}, options.worth)->example,
            0);
}

TEST(Picture, LeavesOutOtherProblemsAndWhatIsNotFinite) {
  CaseRecord other = solved("a", 5), broken = solved("b", 7);
  other.data.hash = "another";
  broken.stages[0].x(0, 0) = std::numeric_limits<double>::quiet_NaN();
  for (const CaseRecord& c : {other, broken}) {
    const Results results({solved("c", 1), c});
    const auto shown = pictured({results, {}, "toy"},
                                {{"C", {"c"}}, {"A", {"a"}}, {"B", {"b"}}});
    ASSERT_TRUE(shown);
    EXPECT_EQ(titles(picture(drawn(), shown)),
              (std::vector<std::string>{"truth 0", "C 1"}));
  }
}

TEST(Picture, SaysThatUnknownsAreNotStoredAndDrawsNothing) {
  CaseRecord without = solved("a", 5);
  without.stages[0].x.resize(0, 0);
  const Results results({without});
  const auto shown = pictured({results, {}, "toy"}, kTwo);
  EXPECT_FALSE(shown);
  const Figure figure = picture(drawn(), shown);
  EXPECT_TRUE(figure.picture);
  EXPECT_TRUE(figure.panels.empty());
  EXPECT_NE(figure.note.find("not stored"), figure.note.npos);
}

TEST(Picture, CirclesCloseAndHaveFewDigits) {
  const Series s = circle("", "ball", 1, 2, 0.2, {});
  EXPECT_EQ(s.x.front(), s.x.back());
  EXPECT_EQ(s.y.front(), s.y.back());
  for (std::size_t k = 0; k < s.x.size(); ++k)
    EXPECT_NEAR(std::hypot(s.x[k] - 1, s.y[k] - 2), 0.2, 1e-4);
  EXPECT_EQ(few_digits(1 / 3.0), 0.3333);
}

}  // namespace
}  // namespace physinv
