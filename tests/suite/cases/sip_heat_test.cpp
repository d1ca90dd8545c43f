// Heat by eigenspaces: the same iterates as by cells, from far fewer numbers.
#include "optimizers/drive.h"
#include "optimizers/lbfgsb.h"
#include "suite/cases/sip/heat/direct.h"
#include "suite/cases/sip/heat/metrics.h"
#include "tests/support/bits.h"
#include "tests/support/quadratic.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Index kExamples = 3;

Outcome solved(heat::Direct solver, Index steps) {
  const auto stage = heat::direct({.solver = solver});
  StageBench bench(*stage, kExamples, steps, problems::heat(), {});
  return bench.run();
}

TEST(HeatDirect, DescentByModesIsDescentByCells) {
  for (const Index steps : {0, 1, 30}) {
    const Outcome cells = solved(heat::Direct::descent, steps),
                  modes = solved(heat::Direct::descent_modes, steps);
    EXPECT_TRUE(Comparator(1e-10, 0)(modes.x, cells.x));
    for (const Index row : {heat::kError, heat::kClamped, heat::kCoarse})
      EXPECT_TRUE(Comparator(1e-8, 0)(modes.arrays.at("metrics").row(row),
                                      cells.arrays.at("metrics").row(row)));
    EXPECT_EQ(modes.iterations(0), double(steps));
  }
}

TEST(HeatDirect, LbfgsbByModesIsLbfgsbByCells) {
  const auto stage = heat::direct({.solver = heat::Direct::descent});
  for (const Index steps : {1, 2, 5, 15}) {
    SCOPED_TRACE(steps);
    const Outcome modes = solved(heat::Direct::lbfgsb_modes, steps);
    StageBench bench(*stage, kExamples, steps, problems::heat(), {});
    Lbfgsb cells(
        {.memory = 10, .pgtol = 1e-14, .ftol = 1e-14, .maxiter = steps});
    drive(
        cells,
        [&](std::span<const Index> active,
            BatchIn<double> x,
            VectorOut<double> loss,
            BatchOut<double> gradient) {
          bench.oracle.evaluate<double>(active, x, loss, gradient);
        },
        bench.oracle.start());
    EXPECT_TRUE(Comparator(1e-6, 0)(modes.x, cells.x()));
    for (std::size_t i = 0; i < kExamples; ++i) {
      EXPECT_EQ(modes.iterations(Index(i)), double(cells.iterations()[i]));
      EXPECT_EQ(modes.evaluations(Index(i)), double(cells.evaluations()[i]));
    }
  }
}

TEST(HeatDirect, InversePhysicsLeadsTheErrors) {
  const auto error = [](heat::Direct solver) {
    const Outcome out = solved(solver, 10);
    const auto& rows = out.arrays.at("metrics");
    EXPECT_EQ(rows.rows(), Index(heat::kMetricRows));
    EXPECT_LT(rows(heat::kError, rows.cols() - 1), rows(heat::kError, 0));
    EXPECT_LE(rows(heat::kClamped, rows.cols() - 1),
              rows(heat::kError, rows.cols() - 1));
    return rows(heat::kError, rows.cols() - 1);
  };
  const double inverse = error(heat::Direct::inverse_physics),
               lbfgsb = error(heat::Direct::lbfgsb_modes),
               descent = error(heat::Direct::descent);
  EXPECT_LT(inverse, lbfgsb);
  EXPECT_LT(lbfgsb, descent);
}

}  // namespace
}  // namespace physinv::test
