#include "suite/harness/progress.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "suite/harness/output.h"
#include "suite/harness/registry.h"
#include "tests/suite/harness/fake_experiment.h"

namespace physinv {
namespace {

TEST(Rates, ByStageThenOverall) {
  Rates rates;
  EXPECT_LT(rates.seconds("fit", 10), 0);
  rates.add("fit", 100, 10);
  rates.add("refine", 100, 1);
  EXPECT_DOUBLE_EQ(rates.seconds("fit", 20), 2);
  EXPECT_DOUBLE_EQ(rates.seconds("refine", 20), 0.2);
  EXPECT_DOUBLE_EQ(rates.seconds("other", 200), 11);
}

/// Of one problem and of nine.
std::vector<Case> two_cases() {
  Registry registry;
  registry.add(fake::experiment());
  Overrides o;
  o.methods = {"descend"};
  o.n = {1, 9};
  return registry.expand("smoke", o);
}

TEST(Progress, EstimatesFromOperations) {
  const auto cases = two_cases();
  ASSERT_EQ(cases.size(), 2u);
  std::FILE* sink = std::fopen("/dev/null", "w");
  Progress progress({.stream = sink}, cases, 1);
  EXPECT_LT(progress.remaining(), 0);
  StageRecord record;
  record.stage = "solve";
  record.clocks.solve.wall = 2;
  progress.finished(0, 0, record);
  EXPECT_NEAR(progress.remaining(), 18, 1e-9);
  progress.reused(1, 0);
  EXPECT_EQ(progress.remaining(), 0);
  std::fclose(sink);
}

TEST(Progress, LinesHaveHeadsOnce) {
  const auto cases = two_cases();
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* stream = open_memstream(&text, &size);
  {
    Progress progress({.stream = stream}, cases, 1);
    StageRecord record;
    record.case_name = cases[0].info.name;
    record.stage = "solve";
    record.stop = Stop::converged;
    record.loss = Vector<double>::Constant(3, 0.531);
    progress.finished(0, 0, record);
    record.case_name = cases[1].info.name;
    record.loss.setConstant(1e-9);
    progress.finished(0, 1, record);
  }
  std::fclose(stream);
  std::istringstream lines{std::string(text, size)};
  std::free(text);
  std::string head, plateau, solved, more;
  std::getline(lines, head), std::getline(lines, plateau);
  std::getline(lines, solved);
  EXPECT_TRUE(head.starts_with("done  case ")) << head;
  EXPECT_NE(head.find("stage   end        median loss      time"), head.npos);
  EXPECT_EQ(head.size(), plateau.size());
  EXPECT_NE(plateau.find("stationary    5.31e-01"), plateau.npos) << plateau;
  EXPECT_NE(solved.find("converged     1.00e-09"), solved.npos) << solved;
  EXPECT_FALSE(std::getline(lines, more));
}

TEST(Duration, Reads) {
  EXPECT_EQ(duration_text(0.0034), "3.4 ms");
  EXPECT_EQ(duration_text(3.44), "3.4 s");
  EXPECT_EQ(duration_text(125), "2 min 5 s");
  EXPECT_EQ(duration_text(4200), "1 h 10 min");
  EXPECT_EQ(duration_text(1e30), "2.8e+26 h");
  for (const double none : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    EXPECT_EQ(duration_text(none), "?");
}

TEST(Output, OneLineOfUtf8) {
  EXPECT_EQ(one_line("a\nb\tc ± é"), "a b c ± é");
  EXPECT_EQ(one_line("\x1b[2J\x7f\r\xff\xc3(\xe0\x80\x80\xed\xa0\x80"),
            "?[2J???"
            "?("
            "??????");
  EXPECT_EQ(one_line("\xc2\x9b\xf5\x80\xf0\x9f\x98\x80"),
            "????\xf0\x9f\x98\x80");
  std::string text;
  for (int i = 0; i < 5000; ++i) text += "é";
  const std::string line = one_line("begin " + text + " end");
  EXPECT_LT(line.size(), 2100U);
  EXPECT_TRUE(line.starts_with("begin é") && line.ends_with("é end"));
  EXPECT_EQ(line.find('?'), std::string::npos);
}

}  // namespace
}  // namespace physinv
