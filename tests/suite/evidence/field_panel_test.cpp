#include "suite/evidence/field_panel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace physinv {
namespace {

// f = 10 i + j at (i, j), 3 x 2 cells, in either order of memory.
TEST(FieldPanel, LiesTheSameHoweverItIsStored) {
  Vector<double> columns(6), rows(6);
  columns << 0, 1, 10, 11, 20, 21;
  rows << 0, 10, 20, 1, 11, 21;
  for (const Panel& p : {field_panel("t", {3, 2, 2, 1, 0.5, 1, 2}, columns),
                         field_panel("t", {3, 2, 1, 3, 0.5, 1, 2}, rows)}) {
    EXPECT_EQ(p.title, "t");
    EXPECT_EQ(p.field->x, (std::vector<double>{1.25, 1.75, 2.25}));
    EXPECT_EQ(p.field->y, (std::vector<double>{2.25, 2.75}));
    EXPECT_EQ(p.field->values, (std::vector<double>{0, 10, 20, 1, 11, 21}));
  }
}

TEST(FieldPanel, FlowsShowTheirSpeedAndSomeArrows) {
  const Vector<double> u = Vector<double>::LinSpaced(16, 0, 15),
                       v = Vector<double>::Constant(16, -1);
  const Panel p = flow_panel("t", {4, 4, 1, 4}, u, v, 2);
  EXPECT_DOUBLE_EQ(p.field->values[7], std::hypot(7, 1));
  EXPECT_EQ(p.arrows->x, (std::vector<double>{1.5, 3.5, 1.5, 3.5}));
  EXPECT_EQ(p.arrows->y, (std::vector<double>{1.5, 1.5, 3.5, 3.5}));
  EXPECT_EQ(p.arrows->u, (std::vector<double>{5, 7, 13, 15}));
  EXPECT_EQ(p.arrows->v, (std::vector<double>{-1, -1, -1, -1}));
}

TEST(FieldPanel, SharedScalesShowEveryFinitePoint) {
  std::vector<Panel> panels(3);
  panels[0].field = Field2D{.values = {1, std::nan(""), -2}};
  panels[2].field = Field2D{.values = {5}};
  share_scale(panels);
  for (const int k : {0, 2}) {
    EXPECT_EQ(panels[k].field->min, -2);
    EXPECT_EQ(panels[k].field->max, 5);
  }
  EXPECT_FALSE(panels[1].field);
}

}  // namespace
}  // namespace physinv
