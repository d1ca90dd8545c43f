#include "suite/harness/run_case.h"

#include <gtest/gtest.h>

#include <bit>
#include <cfenv>
#include <cmath>
#include <filesystem>
#include <limits>

#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/harness/keys.h"
#include "suite/harness/outside.h"
#include "suite/harness/registry.h"
#include "suite/harness/sources.h"
#include "suite/harness/verify.h"
#include "suite/store/file.h"
#include "suite/store/stage_state.h"
#include "tests/suite/harness/fake_experiment.h"
#include "tests/suite/store/store_testing.h"
#include "tests/support/bits.h"
#include "tests/support/float_control.h"

namespace physinv {
namespace {

/// Every stage from the same sources.
Numerics all_from(std::string build) {
  return [=](const Case&, std::size_t) { return build; };
}

/// A project that builds on the suite, with one source.
constexpr SourceFile kStranger[] = {{"stranger/claims.cpp", "0", ""}};
/// A method of it that says what it likes of its work.
class Claims final : public Stage {
 public:
  Claims() : Stage("/home/stranger/claims.cpp") {}
  std::string name() const override { return "solve"; }
  Needs needs() const override { return Needs::forward; }
  Options options() const override { return {}; }
  Index default_iterations() const override { return 12; }
  double operations(const CaseSize&) const override { return 1; }
  Outcome run(StageRun& run) const override {
    // As x86-64 makes it of 0 / 0, and as no processor does.
    const double nan = std::bit_cast<double>(0xfff8000000000000);
    const double odd_nan = std::bit_cast<double>(0x7ff8000000000123);
    const Index n = run.oracle.count();
    Batch<double> x = run.oracle.start();
    Vector<double> loss(n);
    while (run.probe.proceed([&](BatchOut<double> out) { out = x; }))
      run.oracle.evaluate<double>(run.oracle.all(), x, loss);
    x(0, 2) = nan;
    Outcome out;
    out.x = x;
    out.status.assign(static_cast<std::size_t>(n), Status::gtol);
    out.iterations.setConstant(n, 15);
    out.iterations(0) = nan;
    out.evaluations.setConstant(n, -1);
    out.stop = Stop::converged;
    out.arrays["first_step"] = Batch<double>::Constant(1, n, odd_nan);
    return out;
  }
};

class RunCase : public ::testing::Test {
 protected:
  RunCase() { registry_.add(fake::experiment()); }

  Case make(const std::string& method, Overrides o = {}) {
    o.methods = {method};
    if (!o.n) o.n = {5};
    if (!o.seeds) o.seeds = {3};
    if (!o.iterations) o.iterations = 12;
    Case c = registry_.expand("smoke", o).front();
    c.info.keys = content_keys(c, draw_data(c).hash, all_from("build"));
    return c;
  }

  static std::vector<StageRecord> run(const Case& c,
                                      std::vector<StageRecord> earlier = {},
                                      int threads = 1) {
    Threads pool(threads);
    std::vector<StageRecord> records;
    run_case(c, std::move(earlier), options(), &pool, into(records));
    return records;
  }

  static RunOptions options() { return {.trace = true, .revision = "r"}; }
  static CaseHooks into(std::vector<StageRecord>& records) {
    return {.started = {}, .progress = {}, .finished = [&](const auto& r) {
              records.push_back(r);
            }};
  }

  Registry registry_;
};

/// Stages that are left before their end, with a folder for their states.
class LeftCase : public RunCase {
 protected:
  void leave(Leaving (*when)()) {
    left_.checkpoints = {.store = store_, .seconds = 1e9, .leaving = when};
  }

  const TemporaryDirectory folder_;
  const std::filesystem::path store_ = folder_ / "states";
  RunOptions left_ = options();
  std::vector<StageRecord> records_;
};

TEST_F(RunCase, NoStageLeavesItsRoundingToTheNext) {
  const auto standard = float_control();
  const Case c = make("descend");
  const std::string hash = draw_data(c).hash;
  const auto before = run(c);
  const auto other = run(make("floats"));
  EXPECT_EQ(other.front().loss, before.front().curve.loss.col(0));
  EXPECT_EQ(float_control(), standard);
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
  test::expect_same(run(c).front(), before.front());
  // The code that begins may have set it, too.
  flush_subnormals();
  std::fesetround(FE_UPWARD);
  EXPECT_NE(float_control(), standard);
  EXPECT_EQ(draw_data(c).hash, hash);
  const auto after = run(c);
  EXPECT_EQ(float_control(), standard);
  std::fesetenv(FE_DFL_ENV);
  test::expect_same(after.front(), before.front());
}

TEST_F(RunCase, FillsTheRecord) {
  const auto records = run(make("walk"));
  ASSERT_EQ(records.size(), 2u);
  const StageRecord& fit = records[0];
  EXPECT_EQ(fit.case_name, "fake/cubic/walk/n=5/seed=3");
  EXPECT_EQ(fit.stage, "fit");
  EXPECT_EQ(fit.key.size(), 32u);
  EXPECT_EQ(fit.stop, Stop::iterations);
  EXPECT_EQ(fit.iterations, 12);
  EXPECT_EQ(fit.x.cols(), 5);
  EXPECT_EQ(fit.loss.size(), 5);
  EXPECT_EQ(fit.counts[Counter::forward], 13u * 5u);
  EXPECT_GT(fit.clocks.solve.wall, 0);
  EXPECT_GT(fit.buffer_bytes, 0u);
  EXPECT_GT(fit.rss_bytes, 1u << 20);
  EXPECT_EQ(fit.revision, "r");
  EXPECT_EQ(fit.trajectory.size(), 16u);
  EXPECT_EQ(records[1].position, 1);
  EXPECT_LE(records[1].loss.maxCoeff(), fit.loss.maxCoeff());
}

TEST_F(RunCase, SameBitsForAnyThreadsAndWhenResumed) {
  const Case c = make("walk");
  const auto once = run(c), threaded = run(c, {}, 3);
  const auto resumed = run(c, {once[0]});
  for (std::size_t k = 0; k < 2; ++k) test::expect_same(once[k], threaded[k]);
  ASSERT_EQ(resumed.size(), 1u);
  test::expect_same(once[1], resumed[0]);
}

TEST_F(RunCase, ChainsWithTheSameBeginningShareIt) {
  const auto walk = run(make("walk"));
  auto stroll = run(make("stroll"));
  stroll[0].case_name = walk[0].case_name;
  test::expect_same(walk[0], stroll[0]);
  EXPECT_NE(walk[1].key, stroll[1].key);
}

TEST_F(RunCase, ABreachIsNamedFromTheRootOfTheSources) {
  const std::string message = run(make("breach"))[0].message;
  EXPECT_TRUE(message.starts_with("tests/suite/harness/fake_experiment.cpp:"))
      << message;
}

TEST_F(RunCase, CountsOfAMethodFromOutsideAreTheOracles) {
  register_outside({.name = "stranger",
                    .project = "stranger",
                    .root = "/home/stranger",
                    .data = {},
                    .build = {},
                    .plugin = true,
                    .sources = kStranger,
                    .computing = {}});
  Case c = make("descend");
  auto method = std::make_shared<Method>(
      Method{.id = "claims", .chain = {std::make_shared<Claims>()}});
  c.method = method.get();
  c.info.stages = {"solve"};
  const auto records = run(c);
  ASSERT_EQ(records.size(), 1U);
  const StageRecord& r = records[0];
  ASSERT_EQ(r.message, "");
  const auto list = [&](const char* name) {
    return r.arrays.at(ArrayKey::own(name)).reshaped();
  };
  EXPECT_TRUE((r.example_iterations.array() == 12).all());
  EXPECT_TRUE((r.example_evaluations.array() == 12).all());
  EXPECT_EQ(list("claimed_iterations")(1), 15);
  EXPECT_TRUE(std::isnan(list("claimed_iterations")(0)));
  EXPECT_EQ(list("claimed_evaluations")(4), -1);
  EXPECT_EQ(list("overrun")(1), 3);
  EXPECT_EQ(list("overrun")(0), 0);
  EXPECT_EQ(r.status[2], Status::nonfinite) << "its loss is not finite";
  EXPECT_EQ(r.stop, Stop::iterations) << "one has no loss";
  const double nans[] = {r.x(0, 2),
                         r.loss(2),
                         list("claimed_iterations")(0),
                         list("first_step")(1)};
  for (const double v : nans)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(v), 0x7ff8000000000000);
  EXPECT_EQ(source_name("/home/stranger/src/a.h"), "stranger/src/a.h");
  EXPECT_EQ(source_name("/home/other/src/a.h"), "a.h");
  EXPECT_EQ(source_name("/usr/include/physinv/suite/core/oracle.h"),
            "suite/core/oracle.h");
}

TEST_F(RunCase, FailuresAreRecorded) {
  const auto thrown = run(make("broken"));
  ASSERT_EQ(thrown.size(), 2u);
  EXPECT_EQ(thrown[0].stop, Stop::failed);
  EXPECT_EQ(thrown[0].message, "no solution today");
  EXPECT_EQ(thrown[1].stop, Stop::skipped);
  EXPECT_EQ(thrown[1].message, "solve failed");
  EXPECT_EQ(run(make("exhaust"))[0].message, "out of memory");
  EXPECT_EQ(run(make("diverge"))[0].stop, Stop::diverged);
}

TEST_F(RunCase, WhatAFailedStageSpentIsRecorded) {
  const auto gives_up = run(make("give-up"));
  ASSERT_EQ(gives_up.size(), 1u);
  const StageRecord& s = gives_up[0];
  EXPECT_EQ(s.stop, Stop::failed);
  EXPECT_GE(s.clocks.solve.wall, 0.02);
  EXPECT_GE(s.clocks.solve.cpu, 0.02);
  EXPECT_GT(s.clocks.setup.wall, 0);
  EXPECT_EQ(s.counts[Counter::forward], 4u * 5u);
  // A method that runs a problem itself reports its counts only at its end.
  const auto alone = run(make("give-up-alone"))[0];
  EXPECT_EQ(alone.stop, Stop::failed);
  EXPECT_GE(alone.clocks.solve.wall, 0.02);
  EXPECT_FALSE(alone.counts.knows(Counter::forward));
  // Nothing was spent on what was skipped.
  const auto skipped = run(make("broken"))[1];
  EXPECT_EQ(skipped.clocks.total().wall, 0);
  EXPECT_TRUE(skipped.counts.knows(Counter::vjp));
  const StageRecord lost = lost_stage(make("walk"), 0, Stop::failed, "", "");
  EXPECT_FALSE(lost.counts.knows(Counter::forward));
}

TEST_F(RunCase, KeysChangeWithWhatDecides) {
  const Case base = make("walk");
  const auto other = [&](Overrides o) { return make("walk", o).info.keys; };
  EXPECT_EQ(other({}), base.info.keys);
  EXPECT_NE(other({.methods = {}, .n = {{6}}})[0], base.info.keys[0]);
  Overrides o;
  o.seeds = {4};
  EXPECT_NE(other(o)[0], base.info.keys[0]);
  o = {};
  o.iterations = 13;
  EXPECT_NE(other(o)[0], base.info.keys[0]);
  o = {};
  o.precision = Precision::f64;
  EXPECT_NE(other(o)[0], base.info.keys[0]);
  EXPECT_NE(content_keys(base, "data", all_from("build"))[0],
            base.info.keys[0]);
  EXPECT_NE(content_keys(base, draw_data(base).hash, all_from("other"))[0],
            base.info.keys[0]);
}

TEST_F(RunCase, VerifyFindsAWrongLoss) {
  const Case c = make("walk");
  CaseRecord record{.info = c.info, .data = draw_data(c), .stages = run(c)};
  VerifyReport report = verify_results(Results({record}), registry_);
  EXPECT_EQ(report.losses, 10u);
  EXPECT_EQ(report.bitwise + report.close, 10u);
  EXPECT_TRUE(report.mismatches.empty());
  record.stages[0].loss(2) *= 1 + 1e-9;
  report = verify_results(Results({record}), registry_);
  EXPECT_EQ(report.mismatches.size(), 1u);
}

TEST_F(LeftCase, IsLeftWithItsStateLaidDown) {
  std::filesystem::create_directory(store_);
  const Case c = make("descend");
  leave([] { return Leaving::now; });
  // Each start goes one iteration further.
  for (int start = 0; start < 3; ++start)
    EXPECT_THROW(run_case(c, {}, left_, nullptr, into(records_)), StageLeft);
  EXPECT_EQ(records_.size(), 0U);
  EXPECT_EQ(read_state(store_, c.info.keys.front())->iteration, 3);
  left_.checkpoints.leaving = nullptr;
  run_case(c, {}, left_, nullptr, into(records_));
  const auto whole = run(c);
  ASSERT_EQ(records_.size(), whole.size());
  test::expect_same(records_.front(), whole.front());
}

TEST_F(LeftCase, GoesOnInOtherThreadsAndTellsSo) {
  std::filesystem::create_directory(store_);
  const Case c = make("walk");
  leave([] { return Leaving::if_saved; });
  left_.threads = 1;
  Threads one(1), two(2), three(3);
  // The first stage saves nothing and is left at its end.
  EXPECT_THROW(run_case(c, {}, left_, &two, into(records_)), StageLeft);
  ASSERT_EQ(records_.size(), 1U);
  EXPECT_EQ(records_[0].run.thread_changes, "2 from iteration 0");
  EXPECT_TRUE(records_[0].crowded);
  const auto first = records_;
  for (Threads* threads : {&one, &three, &one})
    EXPECT_THROW(run_case(c, first, left_, threads, into(records_)), StageLeft);
  left_.checkpoints.leaving = nullptr;
  run_case(c, first, left_, &one, into(records_));
  ASSERT_EQ(records_.size(), 2U);
  EXPECT_EQ(records_[1].run.thread_changes,
            "3 from iteration 1, 1 from iteration 2");
  const auto whole = run(c);
  for (std::size_t k = 0; k < 2; ++k) test::expect_same(records_[k], whole[k]);
}

TEST_F(LeftCase, IsNotLeftWithoutItsState) {
  write_atomically(store_, "a file where the folder would be");
  const Case c = make("descend");
  leave([] { return Leaving::if_saved; });
  run_case(c, {}, left_, nullptr, into(records_));
  ASSERT_EQ(records_.size(), 1U);
  test::expect_same(records_[0], run(c)[0]);
}

}  // namespace
}  // namespace physinv
