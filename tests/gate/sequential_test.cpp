// Simulated runs: false alarms of A/A, and the smallest slowdown that is found.
#include "suite/gate/sequential.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "suite/core/rng.h"
#include "suite/gate/paired_timing.h"

namespace physinv {
namespace {

constexpr double kAlpha = 0.01, kMargin = 0.02;

/// log(second / first) of two runs that take `noise` more or less, one pair in
/// ten with a disturbance ten times that, of either run; `slowdown` on top.
double pair(Stream& random, double noise, double slowdown) {
  const auto run = [&] {
    const double own = noise * random.normal() / std::sqrt(2.0);
    return random.uniform() < 0.05 ? std::abs(10 * own) : own;
  };
  return run() - run() + std::log1p(slowdown);
}

/// One gate of several cases, looked at after each of so many pairs.
std::vector<Speed> gate(Stream random,
                        std::size_t cases,
                        std::size_t pairs,
                        double noise,
                        double slowdown) {
  std::vector<MedianWatch> watches(cases);
  std::vector<Speed> speeds(cases, Speed::inconclusive);
  for (std::size_t k = 0; k < pairs; ++k) {
    for (auto& watch : watches) watch.add(pair(random, noise, slowdown));
    const auto decisions = decide(watches, kAlpha, kMargin);
    for (std::size_t i = 0; i < cases; ++i)
      if (speeds[i] == Speed::inconclusive) speeds[i] = decisions[i].speed;
  }
  return speeds;
}

bool has(const std::vector<Speed>& all, Speed one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

/// Of so many gates without a change, those that report one.
int alarms(int gates, std::size_t cases, double noise) {
  const Rng root = Rng::root("test/gate/A-A", 0);
  int count = 0;
  for (int i = 0; i < gates; ++i) {
    const auto speeds = gate(root.child(static_cast<std::uint64_t>(i)).stream(),
                             cases,
                             100,
                             noise,
                             0);
    count += has(speeds, Speed::slower) || has(speeds, Speed::faster);
  }
  return count;
}

TEST(Sequential, FalseAlarmsOfTwoHundredSimulatedGates) {
  for (const double noise : {0.01, 0.05, 0.3}) {
    const int count = alarms(200, 8, noise);
    fmt::print("A/A, noise {:g} %: {} of 200 gates\n", 100 * noise, count);
    EXPECT_LE(count, 2);
  }
}

/// Without a margin and with one case, so that alpha is used up more.
TEST(Sequential, TheEvidenceItselfKeepsItsLevel) {
  const Rng root = Rng::root("test/gate/level", 0);
  int excluded = 0, wrong = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Stream random = root.child(i).stream();
    MedianWatch watch;
    bool out = false;
    for (int k = 0; k < 60; ++k) {
      watch.add(random.normal());
      const Interval now = watch.interval(0.1);
      out = out || now.low > 0 || now.high < 0;
    }
    excluded += watch.p_value() <= 0.1;
    wrong += out;
  }
  EXPECT_LE(excluded, 100);
  EXPECT_GE(excluded, 5) << "the test would decide nothing";
  EXPECT_EQ(wrong, excluded);
}

TEST(Sequential, EverythingOnOneSideIsDecidedSoon) {
  std::vector<MedianWatch> one(1);
  std::size_t pairs = 0;
  while (decide(one, kAlpha, kMargin)[0].speed == Speed::inconclusive)
    one[0].add(0.1 + 1e-3 * static_cast<double>(++pairs));
  EXPECT_EQ(decide(one, kAlpha, kMargin)[0].speed, Speed::slower);
  EXPECT_EQ(pairs, 11u);
  EXPECT_GT(decide(one, kAlpha, kMargin)[0].interval.low, 0.09);
}

TEST(Sequential, EqualNeedsANarrowInterval) {
  std::vector<MedianWatch> one(1);
  for (int k = 0; k < 10; ++k) one[0].add(k % 2 == 0 ? 1e-3 : -1e-3);
  EXPECT_EQ(decide(one, kAlpha, kMargin)[0].speed, Speed::inconclusive);
  for (int k = 0; k < 30; ++k) one[0].add(k % 2 == 0 ? 1e-3 : -1e-3);
  EXPECT_EQ(decide(one, kAlpha, kMargin)[0].speed, Speed::equal);
}

/// The smallest slowdown that 95 of 100 simulated gates find.
double found(std::size_t pairs, double noise) {
  for (const double slowdown :
       {0.025, 0.03, 0.04, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0}) {
    const Rng root = Rng::root("test/gate/power", pairs);
    int count = 0;
    for (std::uint64_t i = 0; i < 100; ++i)
      count += has(gate(root.child(i).stream(), 1, pairs, noise, slowdown),
                   Speed::slower);
    if (count >= 95) return slowdown;
  }
  return INFINITY;
}

TEST(Sequential, PowerOverRunTime) {
  std::string table = "slowdown found in 95 of 100 gates\n pairs";
  const auto noises = {0.01, 0.03, 0.1};
  for (const double noise : noises)
    table += fmt::format("  noise {:>3.0f} %", 100 * noise);
  double last = INFINITY;
  for (const std::size_t pairs : {12, 16, 24, 40, 80, 160}) {
    table += fmt::format("\n{:6}", pairs);
    for (const double noise : noises)
      table += fmt::format("  {:>9.1f} %", 100 * found(pairs, noise));
    const double now = found(pairs, 0.03);
    EXPECT_LE(now, last) << "more pairs find less";
    last = now;
  }
  fmt::print("{}\n", table);
  EXPECT_LE(found(24, 0.01), 0.05);
  EXPECT_LE(found(40, 0.03), 0.07);
}

/// Two programs that take as long as the test says.
TEST(PairedTiming, TellsWhoIsSlower) {
  PairedTimingOptions options{.base = "base",
                              .head = "head",
                              .chosen = {},
                              .cases = {"slow", "same", "fast"},
                              .out = {},
                              .seconds = 60};
  Stream random = Rng::root("test/gate/duel", 0).stream();
  std::size_t runs = 0;
  const Runner run = [&](const std::filesystem::path& program,
                         const std::vector<std::string>& cases) {
    ++runs;
    std::vector<double> times;
    for (const auto& name : cases) {
      const double change = program == "base" ? 1.0
                            : name == "slow"  ? 1.1
                            : name == "fast"  ? 0.9
                                              : 1.0;
      times.push_back(change * std::exp(0.015 * random.normal()));
    }
    return times;
  };
  const PairedTiming timing = time_in_pairs(options, run, {});
  EXPECT_EQ(timing.decisions[0].speed, Speed::slower);
  EXPECT_EQ(timing.decisions[1].speed, Speed::equal);
  EXPECT_EQ(timing.decisions[2].speed, Speed::faster);
  EXPECT_EQ(runs,
            2 * *std::max_element(timing.pairs.begin(), timing.pairs.end()));
  EXPECT_EQ(timing.pairs[0], 12u) << "what is decided is not run again";
  EXPECT_LT(timing.pairs[0], timing.pairs[1]);
  const auto findings = findings_of(options, timing, false);
  EXPECT_EQ(findings[0].code, ExitCode::slower);
  EXPECT_EQ(findings[1].code, ExitCode::good);
}

TEST(PairedTiming, WhoHasNoTimeIsNotFaster) {
  const PairedTimingOptions options{.base = "base",
                                    .head = "head",
                                    .chosen = {},
                                    .cases = {"neither", "lost", "gained"},
                                    .out = {},
                                    .seconds = 60};
  std::size_t runs = 0;
  const Runner run = [&](const std::filesystem::path& program,
                         const std::vector<std::string>& cases) {
    ++runs;
    std::vector<double> times;
    for (const auto& name : cases)
      times.push_back(name == (program == "base" ? "lost" : "gained") ? 1.0
                                                                      : NAN);
    return times;
  };
  const auto found =
      findings_of(options, time_in_pairs(options, run, {}), false);
  EXPECT_EQ(runs, 2u) << "what has no time is not run again";
  EXPECT_EQ(found[0].verdict, "not timed");
  EXPECT_EQ(found[0].code, ExitCode::good);
  EXPECT_EQ(found[1].verdict, "lost");
  EXPECT_EQ(found[1].code, ExitCode::accuracy);
  EXPECT_EQ(found[2].code, ExitCode::good);
}

TEST(PairedTiming, StaysOpenWhereTheTimeIsUp) {
  const PairedTimingOptions options{.base = "base",
                                    .head = "head",
                                    .chosen = {},
                                    .cases = {"c"},
                                    .out = {},
                                    .seconds = 0};
  const PairedTiming timing = time_in_pairs(options, {}, {});
  EXPECT_EQ(findings_of(options, timing, false)[0].code, ExitCode::good);
  EXPECT_EQ(findings_of(options, timing, true)[0].code, ExitCode::inconclusive);
  const Finding open = findings_of(options, timing, true)[0];
  EXPECT_EQ(open.verdict, "inconclusive");
  EXPECT_EQ(open.detail, "no pair of runs within the budget");
  EXPECT_FALSE(open.numbers.contains("interval"));
}

}  // namespace
}  // namespace physinv
