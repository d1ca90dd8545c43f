#include "suite/gate/baseline.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "suite/gate/digits.h"
#include "suite/gate/instructions.h"
#include "suite/harness/build_info.h"
#include "suite/store/checksum.h"
#include "suite/store/errors.h"
#include "tests/gate/lines.h"

namespace physinv {
namespace {

Baseline example() {
  Baseline b = blank_baseline(
      {.profile = "smoke", .seeds = "0-3", .filters = {"a b", "-c"}});
  b.stages = {line("a/b/m/n=4/seed=0/fit"), line("a/b/m/n=4/seed=0/refine")};
  b.stages[1].losses = {std::nan(""), std::nan(""), std::nan(""), 4};
  b.stages[1].stop = Stop::diverged;
  b.stages[1].digits = kNoDigits;
  b.stages[0].x = -0.1;
  b.counts = {"callgrind x86-64-v3", {{"a/b/m/n=4/seed=0", 123456789}}};
  return b;
}

TEST(Baseline, ReadsWhatItWrote) {
  const Baseline b = example();
  const std::string text = to_text(b);
  const Baseline read = parse_baseline(text, "here");
  EXPECT_EQ(to_text(read), text);
  EXPECT_EQ(read.chosen.filters, b.chosen.filters);
  EXPECT_EQ(read.bits, bits_text());
  EXPECT_EQ(read.build, build_text());
  ASSERT_EQ(read.stages.size(), 2u);
  EXPECT_EQ(read.stages[0].work, b.stages[0].work);
  EXPECT_EQ(read.stages[0].jitter, b.stages[0].jitter);
  EXPECT_EQ(read.stages[0].statuses, b.stages[0].statuses);
  EXPECT_EQ(read.stages[0].x, b.stages[0].x);
  EXPECT_FALSE(read.stages[1].x);
  EXPECT_EQ(read.stages[1].digits, kNoDigits);
  EXPECT_EQ(read.stages[1].losses.nonfinite, 4);
  EXPECT_TRUE(std::isnan(read.stages[1].losses.median));
  EXPECT_EQ(read.counts.lines.at(0).instructions, 123456789u);
}

TEST(Counts, CompareOnTheProcessorThatRecordedThem) {
  EXPECT_EQ(counted_processor("callgrind x86-64-v3"), "x86-64");
  EXPECT_EQ(counted_processor("perf aarch64"), "aarch64");
  EXPECT_EQ(counted_processor("callgrind"), "x86-64");
  for (const auto* set : {"x86-64-v3", "x86-64-v4"})
    EXPECT_EQ(not_comparable("callgrind x86-64-v3", set), "");
  EXPECT_EQ(not_comparable("perf aarch64", "aarch64"), "");
  EXPECT_EQ(not_comparable("callgrind x86-64-v3", "aarch64"),
            "instruction counts were recorded on x86-64 and are not compared "
            "on aarch64");
  EXPECT_NE(not_comparable("perf aarch64", "x86-64-v4"), "");
}

TEST(Counts, OfThisBuildCompareHere) {
  for (const auto counting : {Counting::perf, Counting::callgrind})
    EXPECT_EQ(
        not_comparable(counter_name(counting), build_info().instruction_set),
        "");
}

TEST(Baseline, EveryFlippedBitIsSeen) {
  const std::string text = to_text(example());
  for (std::size_t i = 0; i < text.size(); ++i)
    for (const int bit : {0, 3, 7}) {
      std::string wrong = text;
      wrong[i] = static_cast<char>(wrong[i] ^ (1 << bit));
      EXPECT_ANY_THROW(parse_baseline(wrong, "here")) << i;
    }
  for (std::size_t size = 0; size < text.size(); ++size)
    EXPECT_ANY_THROW(parse_baseline(text.substr(0, size), "here")) << size;
}

TEST(Baseline, DamageAndOtherFilesAreToldApart) {
  std::string text = to_text(example());
  EXPECT_THROW(parse_baseline("{}", "here"), UnreadableInput);
  const auto sealed = [](const std::string& body) {
    return body + fmt::format("checksum {:08x}\n", crc32c(body));
  };
  EXPECT_THROW(parse_baseline(sealed("physinv-bench baseline 2\n"), "here"),
               UnreadableInput);
  EXPECT_THROW(
      parse_baseline(sealed("physinv-bench baseline 1\nstages 0\n"), "here"),
      UnreadableInput);
  EXPECT_THROW(
      parse_baseline(sealed("physinv-bench baseline 1\nstages 1\na b=c\n"),
                     "here"),
      UnreadableInput);
  text[text.size() / 2] ^= 1;
  EXPECT_THROW(parse_baseline(text, "here"), StoreError);
}

TEST(Digits, AreWhatOneUlpLeaves) {
  EXPECT_EQ(stable_digits(0, 12), 12);
  EXPECT_EQ(stable_digits(2e-5, 12), 3);
  EXPECT_EQ(stable_digits(-2e-5, 12), 3);
  EXPECT_EQ(stable_digits(1e-17, 12), 12);
  EXPECT_EQ(stable_digits(0.2, 12), kNoDigits);
  EXPECT_EQ(stable_digits(0.05, 12), 0);
  EXPECT_EQ(stable_digits(4, 12), kNoDigits);
  EXPECT_EQ(stable_digits(std::numeric_limits<double>::infinity(), 12),
            kNoDigits);
  EXPECT_DOUBLE_EQ(log_distance(1, 100), 2);
  EXPECT_DOUBLE_EQ(log_distance(-1, -3), -2.0 / 3);
  EXPECT_EQ(log_distance(std::nan(""), std::nan("")), 0);
  EXPECT_GT(log_distance(1, std::nan("")), 1e300);
  EXPECT_LT(log_distance(std::nan(""), 1), -1e300);
}

TEST(Digits, OfAStageThatNoDisturbanceReachedAreFew) {
  StageLine a = line("c/s"), b = a;
  enter_disturbed(a, b, Precision::f64);
  EXPECT_EQ(a.digits, 3);
  b.trajectory = "0000000000000001";
  enter_disturbed(a, b, Precision::f64);
  EXPECT_EQ(a.digits, 12);
  enter_disturbed(a, b, Precision::f32);
  EXPECT_EQ(a.digits, 5);
  b.losses.median *= 1.01;
  b.work[0] += 3;
  enter_disturbed(a, b, Precision::f64);
  EXPECT_EQ(a.digits, 1);
  EXPECT_EQ(a.jitter[0], 3u);
}

}  // namespace
}  // namespace physinv
