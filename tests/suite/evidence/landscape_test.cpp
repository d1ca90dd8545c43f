#include "suite/evidence/landscape.h"

#include <gtest/gtest.h>

#include <vector>

namespace physinv {
namespace {

/// y = (x1 + g, 2 x2): its loss for y* = 0 is ((x1 + g)^2 + 4 x2^2) / 2.
class Stretch final : public Problem<double>, public Vjp<double> {
 public:
  Shape shape() const override { return {2, 2, 1}; }
  Vector<double> start() const override { return Vector<double>::Zero(2); }
  void draw(Stream&, SampleOut&) const override {}
  void forward(Point<double> at,
               BatchOut<double> y,
               Workspace&) const override {
    const auto &x = at.x, &given = at.given;
    y.row(0) = x.row(0) + given.row(0), y.row(1) = 2 * x.row(1);
  }
  void linearize(Point<double> at, BatchOut<double> y, Tape&) const override {
    Workspace work;
    forward(at, y, work);
  }
  void pullback(const Tape&,
                BatchIn<double> y_bar,
                BatchOut<double> x_bar,
                Workspace&) const override {
    x_bar.row(0) = y_bar.row(0), x_bar.row(1) = 2 * y_bar.row(1);
  }
  double operations() const override { return 1; }
};

const Observed kZero{Vector<double>::Zero(2), Vector<double>::Ones(1)};

TEST(Landscape, AFieldHasTheFirstUnknownToTheRight) {
  const Field2D f = loss_over_plane(Stretch(), kZero, {0, 1}, {0, 1, 2});
  EXPECT_EQ(f.x, (std::vector<double>{0, 1}));
  EXPECT_EQ(f.y, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(f.values, (std::vector<double>{0.5, 2, 2.5, 4, 8.5, 10}));
  EXPECT_TRUE(f.log_scale);
}

TEST(Landscape, ADerivativeIsAlongTheAxisThatIsDrawn) {
  Batch<double> x(2, 3);
  x << 0, 0, 0, 0, 1, 2;
  const Vector<double> at = 10 * x.row(1);
  const auto panels = loss_and_derivative(
      Stretch(),
      kZero,
      x,
      {.label = "ten times x2", .at = at, .unknown = 1, .scale = 10},
      "m");
  ASSERT_EQ(panels.size(), 2U);
  for (const Panel& p : panels) {
    EXPECT_EQ(p.x_label, "ten times x2");
    EXPECT_EQ(p.series[0].method, "m");
    EXPECT_EQ(p.series[0].x, (std::vector<double>{0, 10, 20}));
  }
  EXPECT_EQ(panels[0].series[0].y, (std::vector<double>{0.5, 2.5, 8.5}));
  EXPECT_EQ(panels[1].series[0].y, (std::vector<double>{0, 0.4, 0.8}));
}

}  // namespace
}  // namespace physinv
