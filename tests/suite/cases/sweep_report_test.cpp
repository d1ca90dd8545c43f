#include "suite/cases/numerics/common/sweep_report.h"

#include <gtest/gtest.h>

#include "suite/diagnostics/stability_sweep.h"
#include "suite/results/published.h"

namespace physinv {
namespace {

/// 2 x 2 points with one example: fine, float off, float NaN, all NaN.
StageRecord four_cells() {
  StageRecord s;
  s.stage = "grid";
  s.arrays["status"].resize(kSweepChecks, 4);
  s.arrays["status"] << 0, 0, 0, 2,  //
      0, 1, 2, 2,                    //
      0, 0, 3, 2,                    //
      0, 0, 0, 2,                    //
      0, 1, 2, 2;
  s.arrays["error"].resize(kSweepChecks, 4);
  s.arrays["error"] << 0, 0, 0, -1,  //
      1e-7, 1e-2, -1, -1,            //
      1e-9, 1e-8, -1, -1,            //
      0, 1e-13, 1e-12, -1,           //
      1e-6, 0.1, -1, -1;
  return s;
}

const SweepAxis kX{"x", {1, 2}}, kY{"y", {10, 20}};

TEST(SweepReport, CountsCellsByStatus) {
  const StageRecord s = four_cells();
  const Table table = sweep_table("t", "T", &s);
  ASSERT_EQ(table.rows.size(), 5U);
  const auto counts = [&](std::size_t row) {
    std::vector<double> out;
    for (std::size_t c = 0; c < 4; ++c)
      out.push_back(*table.rows[row].cells[c].ours);
    return out;
  };
  EXPECT_EQ(counts(0), (std::vector<double>{3, 0, 1, 0}));
  EXPECT_EQ(counts(1), (std::vector<double>{1, 1, 2, 0}));
  EXPECT_EQ(counts(2), (std::vector<double>{2, 0, 1, 1}));
  EXPECT_EQ(table.rows[1].cells[4].text, "1.0e-02");
}

TEST(SweepReport, MapsHaveStatusesAndBlanksInsteadOfNan) {
  const StageRecord s = four_cells();
  const Figure figure = sweep_maps("f", "F", kX, kY, &s);
  ASSERT_EQ(figure.panels.size(), 4U);
  EXPECT_EQ(figure.panels[0].field->values, (std::vector<double>{0, 1, 2, 3}));
  EXPECT_EQ(figure.panels[1].field->values,
            (std::vector<double>{1e-7, 1e-2, 0, 0}));
  EXPECT_TRUE(figure.panels[1].field->log_scale);
}

TEST(SweepReport, MapsShowTheWorstExample) {
  StageRecord s = four_cells();
  const Figure figure = sweep_maps("f", "F", kX, {"y", {10}}, &s);
  EXPECT_EQ(figure.panels[0].field->values, (std::vector<double>{1, 3}));
}

/// How the claim on the stages `grid` and `other` is judged.
ClaimResult adjoint(const std::vector<StageRecord>& sweeps) {
  CaseRecord c;
  c.info.experiment = "numerics/toy";
  c.info.method = "stability";
  c.info.profile = "smoke";
  c.stages = sweeps;
  for (const StageRecord& s : sweeps) c.info.stages.push_back(s.stage);
  const Results results({c});
  return judge({adjoint_claim("N1", {"grid", "other"})},
               {results, {}, "numerics/toy"},
               {"smoke"})
      .front();
}

StageRecord other_cells() {
  StageRecord s = four_cells();
  s.stage = "other";
  return s;
}

TEST(SweepReport, TheAdjointClaimLooksAtFiniteCellsOnly) {
  const ClaimResult good = adjoint({four_cells(), other_cells()});
  EXPECT_EQ(good.verdict, Verdict::reproduced);
  EXPECT_EQ(good.conditions[0].value, 6);
  EXPECT_EQ(good.conditions[2].value, 2);
  EXPECT_EQ(adjoint({four_cells()}).verdict, Verdict::not_judged);
  EXPECT_EQ(adjoint({}).verdict, Verdict::not_judged);
  for (const Index row : {2, 3}) {
    for (const double bad : {1, 2}) {
      StageRecord wrong = other_cells();
      wrong.arrays["status"](row, 1) = bad;
      EXPECT_EQ(adjoint({four_cells(), wrong}).verdict,
                Verdict::not_reproduced);
    }
  }
}

TEST(SweepReport, WithoutASweepNothingWasRun) {
  const Table table = sweep_table("t", "T", nullptr);
  EXPECT_EQ(table.rows[0].cells[0].text, "not run");
  EXPECT_FALSE(table.rows[0].cells[0].ours);
  EXPECT_TRUE(sweep_maps("f", "F", kX, kY, nullptr).panels.empty());
}

TEST(SweepReport, FindsTheStageOfTheMethod) {
  CaseRecord c;
  c.info.experiment = "numerics/toy";
  c.info.method = "stability";
  c.stages = {four_cells()};
  const Results results({c});
  const Published none;
  const Evidence toy{results, none, "numerics/toy"};
  EXPECT_NE(find_sweep(toy, "grid"), nullptr);
  EXPECT_EQ(find_sweep(toy, "x"), nullptr);
  EXPECT_EQ(find_sweep(toy.of("other"), "grid"), nullptr);
  c.info.method = "growth";
  const Results other({c});
  EXPECT_EQ(find_sweep({other, none, "numerics/toy"}, "grid"), nullptr);
}

}  // namespace
}  // namespace physinv
