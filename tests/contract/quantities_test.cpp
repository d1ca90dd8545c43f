// Names of the columns of problems' arrays, against the shapes.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/registered.h"

namespace physinv::test {
namespace {

Index listed(const std::string& text) {
  return text.empty() ? 0 : 1 + std::count(text.begin(), text.end(), ',');
}

/// A field, u(i, j), stands for any number of columns.
bool fits(const Quantities::Array& meaning, Index columns) {
  const bool field = meaning.names.find('(') != std::string::npos;
  return field ? columns > 0
               : listed(meaning.names) == columns &&
                     (listed(meaning.unit) == 1 ||
                      listed(meaning.unit) == columns);
}

TEST(Quantities, NameEveryColumnOfEveryProblem) {
  for (const auto& e : registry().experiments()) {
    const Quantities& q = e->problem.quantities;
    const Shape shape = e->problem.make<double>()->shape();
    EXPECT_TRUE(fits(q.unknowns, shape.unknowns)) << e->name;
    EXPECT_TRUE(fits(q.observations, shape.observations)) << e->name;
    EXPECT_TRUE(fits(q.given, shape.given)) << e->name;
  }
}

TEST(Quantities, StandInEveryCase) {
  for (const Case& c : registry().expand("smoke")) {
    EXPECT_EQ(c.info.about.problem, c.experiment->problem.name);
    EXPECT_FALSE(c.info.about.unknowns.names.empty()) << c.info.name;
  }
}

}  // namespace
}  // namespace physinv::test
