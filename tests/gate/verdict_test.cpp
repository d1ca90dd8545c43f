#include "suite/gate/verdict.h"

#include <gtest/gtest.h>

#include <functional>

#include "suite/gate/instructions.h"
#include "suite/gate/sheet.h"
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

TEST(Sheet, TheGravestCodeCounts) {
  Sheet sheet;
  EXPECT_EQ(sheet.code(), ExitCode::good);
  sheet.findings = {{.kind = "clock", .code = ExitCode::inconclusive},
                    {.kind = "clock", .code = ExitCode::slower}};
  EXPECT_EQ(sheet.code(), ExitCode::slower);
  sheet.findings.push_back({.kind = "accuracy", .code = ExitCode::accuracy});
  EXPECT_EQ(sheet.code(), ExitCode::accuracy);
}

TEST(Sheet, SaysTheSameToEverybody) {
  Sheet sheet;
  sheet.notes = {"a note"};
  for (const auto& j :
       judge({line("a|b/s"), line("b/s")}, {line("b/s")}, kBits))
    sheet.findings.push_back(finding_of(j));
  EXPECT_EQ(summary_text(sheet), "accuracy: 1 missing, 1 same");
  EXPECT_NE(terminal_text(sheet).find("missing"), std::string::npos);
  EXPECT_EQ(terminal_text(sheet).find(" same  "), std::string::npos);
  EXPECT_NE(markdown_text(sheet).find("gate: failed"), std::string::npos);
  EXPECT_NE(markdown_text(sheet).find("a\\|b/s"), std::string::npos);
  EXPECT_EQ(annotations(sheet).find("::error title=accuracy missing::a|b/s"),
            0u);
  const auto json = to_json(sheet);
  EXPECT_EQ(json.at("exit_code"), 5);
  EXPECT_EQ(json.at("findings").size(), 2u);
}

}  // namespace
}  // namespace physinv
