#include "suite/gate/verdict.h"

#include <gtest/gtest.h>

#include <functional>

#include "suite/gate/gate_report.h"
#include "suite/gate/instructions.h"
#include "tests/gate/lines.h"

namespace physinv {
namespace {

constexpr Rules kBits{.bits = true}, kDigits{.bits = false};

/// What becomes of a stage that differs like this; its trajectory does, too.
StageVerdict changed(Rules rules,
                     const std::function<void(StageLine&)>& change) {
  StageLine now = line("c/s");
  now.trajectory = "ffffffffffffffff";
  change(now);
  return judge(line("c/s"), now, rules);
}
void nothing(StageLine&) {}

TEST(Verdict, SameBitsAreTheSame) {
  EXPECT_EQ(judge(line("c/s"), line("c/s"), kBits).change, Change::same);
}

TEST(Verdict, OtherBitsFailWhereTheSameArePromised) {
  EXPECT_EQ(changed(kBits, nothing).change, Change::worse);
  EXPECT_EQ(changed(kDigits, nothing).change, Change::within);
  StageLine now = line("c/s");
  now.results = "0";
  EXPECT_EQ(judge(line("c/s"), now, kBits).change, Change::worse);
}

TEST(Verdict, LossesAreJudgedByTheirDigits) {
  const auto by = [](double factor) {
    return changed(kDigits, [&](StageLine& l) { l.losses.median *= factor; });
  };
  EXPECT_EQ(by(1.0002).change, Change::within);
  EXPECT_EQ(by(1.0005).change, Change::worse);
  EXPECT_EQ(by(0.9995).change, Change::better);
  EXPECT_NE(by(1.0005).reasons.worse.at(0).find("median loss"),
            std::string::npos);
}

TEST(Verdict, OneWorseThingOutweighsABetterOne) {
  EXPECT_EQ(changed(kDigits,
                    [](StageLine& l) {
                      l.losses.median /= 10;
                      l.losses.worst *= 10;
                    })
                .change,
            Change::worse);
}

TEST(Verdict, ReasonsForAndAgainstAreApart) {
  const auto j = changed(kDigits, [](StageLine& l) {
    l.losses.median /= 10;
    l.losses.worst *= 10;
  });
  EXPECT_EQ(j.reasons.worse.size(), 1u);
  EXPECT_EQ(j.reasons.better.size(), 1u);
  const std::string text = j.reasons.text();
  EXPECT_EQ(text.find("worse: worst loss"), 0u) << text;
  EXPECT_NE(text.find("; better: median loss"), std::string::npos) << text;
  const auto json =
      to_json(GateReport{{}, {finding_of(j)}}).at("findings").at(0);
  EXPECT_EQ(json.at("worse").size(), 1u);
  EXPECT_EQ(json.at("better").size(), 1u);
}

TEST(Verdict, TheSizeOfAChangeIsNamed) {
  StageLine before = line("c/s"), now = before;
  before.x = 3.0;
  now.x = 3.0 * (1 + 3e-16), now.x_norm = 2.0;
  now.results = "0";
  const auto said = [&](const StageLine& stage) {
    return largest_text(
        GateReport{{}, {finding_of(judge(before, stage, kBits))}});
  };
  EXPECT_EQ(said(now), "largest relative change 3.0e-16 in x of c/s");
  now.losses.worst *= 1.5;
  EXPECT_NE(said(now).find("3.3e-01 in the worst loss"), std::string::npos);
  now = before, now.results = "0";
  now.losses.worst *= 1 + 1e-9;  // beyond the four digits of the line
  EXPECT_EQ(said(now), "");
  EXPECT_NE(finding_of(judge(before, now, kBits))
                .detail.find("to the recorded digits"),
            std::string::npos);
}

TEST(Verdict, WhoFailsSavesNoWork) {
  StageLine failed = line("c/s");
  failed.stop = Stop::failed;
  failed.results = "0";
  failed.work = {};
  const auto worse = judge(line("c/s"), failed, kBits);
  EXPECT_EQ(worse.change, Change::worse);
  EXPECT_TRUE(worse.reasons.better.empty());
  EXPECT_EQ(judge(failed, line("c/s"), kBits).change, Change::better);
}

TEST(Verdict, ChangesOfEndsAreNamed) {
  const auto j =
      changed(kDigits, [](StageLine& l) { l.stop = Stop::diverged; });
  EXPECT_EQ(j.change, Change::worse);
  EXPECT_EQ(j.reasons.worse.at(0), "converged -> diverged");
  EXPECT_EQ(changed(kDigits,
                    [](StageLine& l) {
                      l.statuses = {4, 0, 0, 0};
                    })
                .reasons.other.at(0),
            "gtol 3, maxiter 1 -> gtol 4");
  EXPECT_EQ(changed(kDigits,
                    [](StageLine& l) {
                      l.statuses = {3, 0, 0, 1};
                    })
                .change,
            Change::worse);
}

TEST(Verdict, ALossThatIsNotFiniteIsWorse) {
  for (const Rules rules : {kBits, kDigits})
    EXPECT_EQ(
        changed(rules, [](StageLine& l) { l.losses.nonfinite = 1; }).change,
        Change::worse);
  StageLine before = line("c/s"), now = before;
  before.losses.nonfinite = 1;
  now.results = "0";
  now.losses.worst *= 10;  // of one more
  EXPECT_EQ(judge(before, now, kBits).change, Change::better);
  now.losses.best *= 10;
  EXPECT_EQ(judge(before, now, kBits).change, Change::worse);
}

TEST(Verdict, WorkMustNotGrow) {
  StageLine now = line("c/s");
  now.work[1] += 1;
  EXPECT_EQ(judge(line("c/s"), now, kBits).change, Change::worse);
  EXPECT_EQ(judge(line("c/s"), now, {.bits = true, .allow_work = true}).change,
            Change::same);
  now.work[1] -= 2;
  EXPECT_EQ(judge(line("c/s"), now, kBits).change, Change::better);
  now.results = "0";
  EXPECT_EQ(judge(line("c/s"), now, kBits).change, Change::worse);
  now = line("c/s");
  now.work[1] -= 1;
  // In another build, by twice what an ulp in the data moved.
  now.work[1] += 5;
  EXPECT_EQ(judge(line("c/s"), now, kDigits).change, Change::same);
  now.work[1] += 1;
  EXPECT_EQ(judge(line("c/s"), now, kDigits).change, Change::worse);
}

TEST(Verdict, MissingAndNewStagesAreNamed) {
  const auto all =
      judge({line("a/s"), line("b/s")}, {line("b/s"), line("c/s")}, kBits);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].change, Change::missing);
  EXPECT_TRUE(fails(all[0]));
  EXPECT_EQ(all[1].change, Change::same);
  EXPECT_EQ(all[2].change, Change::added);
  EXPECT_FALSE(fails(all[2]));
}

TEST(Instructions, OnePercentIsTheLimit) {
  EXPECT_EQ(judge({"c", 100000}, {"c", 100999}).code, ExitCode::good);
  EXPECT_EQ(judge({"c", 100000}, {"c", 101001}).code, ExitCode::slower);
  EXPECT_EQ(judge({"c", 100000}, {"c", 90000}).verdict, "faster");
}

TEST(GateReport, AClockThatDecidesNothingIsLoud) {
  GateReport report;
  EXPECT_EQ(undecided_text(report), "");
  report.findings = {{.kind = "clock", .name = "c", .verdict = "inconclusive"}};
  EXPECT_EQ(
      undecided_text(report).find("the timing comparison decided 0 of 1 cases"),
      0u);
  EXPECT_NE(terminal_text(report).find("warning: the timing comparison"),
            std::string::npos);
  EXPECT_EQ(annotations(report).find("::warning title="), 0u);
  EXPECT_NE(markdown_text(report).find("passed, timing undecided"),
            std::string::npos);
  report.findings.push_back({.kind = "clock", .name = "d", .verdict = "equal"});
  EXPECT_EQ(undecided_text(report), "");
}

TEST(GateReport, TheGravestCodeCounts) {
  GateReport report;
  EXPECT_EQ(report.code(), ExitCode::good);
  report.findings = {{.kind = "clock", .code = ExitCode::inconclusive},
                     {.kind = "clock", .code = ExitCode::slower}};
  EXPECT_EQ(report.code(), ExitCode::slower);
  report.findings.push_back({.kind = "accuracy", .code = ExitCode::accuracy});
  EXPECT_EQ(report.code(), ExitCode::accuracy);
}

TEST(GateReport, SaysTheSameToEverybody) {
  GateReport report;
  report.notes = {"a note"};
  for (const auto& j :
       judge({line("a|b/s"), line("b/s")}, {line("b/s")}, kBits))
    report.findings.push_back(finding_of(j));
  EXPECT_EQ(summary_text(report), "accuracy: 1 missing, 1 same");
  EXPECT_NE(terminal_text(report).find("missing"), std::string::npos);
  EXPECT_EQ(terminal_text(report).find(" same  "), std::string::npos);
  EXPECT_NE(markdown_text(report).find("gate: failed"), std::string::npos);
  EXPECT_NE(markdown_text(report).find("a\\|b/s"), std::string::npos);
  EXPECT_EQ(annotations(report).find("::error title=accuracy missing::a|b/s"),
            0u);
  const auto json = to_json(report);
  EXPECT_EQ(json.at("exit_code"), 5);
  EXPECT_EQ(json.at("findings").size(), 2u);
}

TEST(StageLine, OfAFailedStageHasNeitherWorkNorTime) {
  StageRecord r;
  r.counts[Counter::vjp] = 7;
  r.clocks.solve = {2, 2};
  EXPECT_EQ(line_of(r).work[2], 7U);
  EXPECT_EQ(line_of(r).fastest, 2000);
  r.stop = Stop::failed;
  EXPECT_EQ(line_of(r).work[2], 0U);
  EXPECT_EQ(line_of(r).fastest, 0);
}

}  // namespace
}  // namespace physinv
