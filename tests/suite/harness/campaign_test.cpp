#include "suite/harness/campaign.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "suite/harness/registry.h"
#include "suite/harness/select.h"
#include "suite/harness/verify.h"
#include "suite/results/results.h"
#include "suite/results/tidy.h"
#include "suite/store/catalog.h"
#include "suite/store/missing_work.h"
#include "suite/store/results_file.h"
#include "suite/store/storable.h"
#include "tests/suite/harness/fake_experiment.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

class CampaignTest : public ::testing::Test {
 protected:
  CampaignTest() {
    registry_.add(fake::experiment());
    std::string pattern =
        (fs::temp_directory_path() / "campaignXXXXXX").string();
    root_ = mkdtemp(pattern.data());
    sink_ = std::fopen("/dev/null", "w");
  }
  ~CampaignTest() override {
    std::fclose(sink_);
    fs::remove_all(root_);
  }

  CampaignResult run(const std::string& profile,
                     CampaignOptions options,
                     bool backwards = false,
                     const std::string& filter = "") {
    auto cases = NameFilter({filter}).apply(registry_.expand(profile));
    if (backwards) std::reverse(cases.begin(), cases.end());
    options.trace = true;
    return run_campaign(
        prepare(std::move(cases)), options, {}, {.stream = sink_});
  }

  /// More cores than cases; every stage that can leaves its worker.
  CampaignOptions sharing(const char* out) const {
    return {
        .out = root_ / out, .jobs = 9, .share_cores = true, .share_seconds = 0};
  }

  /// Everything that must not depend on how a campaign is run.
  static std::string bits(const fs::path& dir) {
    std::map<std::string, std::string> stages;
    const Results results = load_results(dir);
    for (const auto& c : results.cases()) {
      for (const auto& s : c.stages) {
        std::string all = s.key + s.trajectory;
        const auto add = [&](const auto& m) {
          all.append(reinterpret_cast<const char*>(m.data()),
                     static_cast<std::size_t>(m.size()) * sizeof(double));
        };
        add(s.x), add(s.loss), add(s.curve.loss), add(s.curve.x);
        for (const auto& [name, array] : s.arrays) add(array);
        stages[c.info.name + s.stage] = all;
      }
    }
    std::string text;
    for (const auto& [name, all] : stages) text += name + all;
    return text;
  }

  Registry registry_;
  fs::path root_;
  std::FILE* sink_;
};

TEST_F(CampaignTest, SameBitsForJobsThreadsAndOrder) {
  const auto result = run("quick", {.out = root_ / "a", .jobs = 1});
  EXPECT_EQ(result.stages_run + result.stages_reused, 30u);
  EXPECT_TRUE(result.failed.empty());
  run("quick", {.out = root_ / "b", .jobs = 7, .threads = 2});
  run("quick", {.out = root_ / "c", .jobs = 2}, true);
  const std::string once = bits(root_ / "a");
  EXPECT_GT(once.size(), 10000u);
  EXPECT_EQ(once, bits(root_ / "b"));
  EXPECT_EQ(once, bits(root_ / "c"));
}

TEST(LargestFirst, SortsByWorkAndKeepsTheOrderOfEqualOnes) {
  EXPECT_EQ(largest_first({4, 1, 3, 0}, {2, 5, 9, 2, 7}),
            (std::vector<std::size_t>{4, 1, 3, 0}));
  EXPECT_EQ(largest_first({0, 1, 2, 3, 4}, {2, 5, 9, 2, 7}),
            (std::vector<std::size_t>{2, 4, 1, 0, 3}));
}

TEST_F(CampaignTest, AWorkerThatStandsStillIsNamed) {
  setenv("PHYSINV_FAKE_PACE_MS", "900", 1);
  Overrides one;
  one.methods = {"descend"}, one.iterations = 1;
  std::FILE* output = std::tmpfile();
  const auto result = run_campaign(prepare(registry_.expand("smoke", one)),
                                   {.out = root_ / "a", .still_seconds = 0.3},
                                   {},
                                   {.stream = output});
  unsetenv("PHYSINV_FAKE_PACE_MS");
  EXPECT_EQ(result.stages_run, 1u);
  std::rewind(output);
  std::string text(4096, ' ');
  text.resize(std::fread(text.data(), 1, text.size(), output));
  std::fclose(output);
  EXPECT_NE(text.find("descend/n=4/seed=0 solve: its worker made no progress "
                      "and used no CPU time for 0.3 s"),
            std::string::npos)
      << text;
}

TEST_F(CampaignTest, FreeCoresGoToStagesThatSaveTheirState) {
  const char* two = "/(descend|walk)/";
  run("smoke", {.out = root_ / "a", .jobs = 2}, false, two);
  setenv("PHYSINV_FAKE_PACE_MS", "40", 1);
  run("smoke", sharing("b"), false, two);
  unsetenv("PHYSINV_FAKE_PACE_MS");
  EXPECT_EQ(bits(root_ / "a"), bits(root_ / "b"));
  const Results with = load_results(root_ / "b");
  const auto changes = [&](const char* method, const char* stage) {
    return with.find("fake/cubic", method, 4, 0, stage)->run.thread_changes;
  };
  EXPECT_NE(changes("descend", "solve").find(" from iteration "),
            std::string::npos);
  // It saves no state; the stage after it has more threads from its start on.
  EXPECT_EQ(changes("walk", "fit"), "");
  EXPECT_NE(changes("walk", "refine").find(" from iteration 0"),
            std::string::npos);
  for (const auto& c : with.cases()) {
    for (const auto& s : c.stages) {
      EXPECT_EQ(s.run.threads, 1);
      EXPECT_TRUE(s.crowded || s.run.thread_changes.empty());
    }
  }
  const Results without = load_results(root_ / "a");
  for (const auto& c : without.cases())
    for (const auto& s : c.stages) EXPECT_EQ(s.run.thread_changes, "");
}

TEST_F(CampaignTest, ACaseThatCannotGoOnKeepsItsThreads) {
  run("smoke", {.out = root_ / "a"}, false, "/descend/");
  setenv("PHYSINV_FAKE_PACE_MS", "40", 1);
  setenv("PHYSINV_FAKE_PLANT", "a crash when going on", 1);
  const auto result = run("smoke", sharing("b"), false, "/descend/");
  unsetenv("PHYSINV_FAKE_PLANT");
  unsetenv("PHYSINV_FAKE_PACE_MS");
  EXPECT_TRUE(result.failed.empty());
  EXPECT_EQ(bits(root_ / "a"), bits(root_ / "b"));
  const Results with = load_results(root_ / "b");
  EXPECT_EQ(
      with.find("fake/cubic", "descend", 4, 0, "solve")->run.thread_changes,
      "");
}

/// Sends a signal to this process once a state in `folder` was saved in several
/// threads; a process of its own, as workers are forked meanwhile.
pid_t interrupt_when_shared(const fs::path& folder) {
  const pid_t parent = getpid(), child = fork();
  if (child != 0) return child;
  for (int k = 0; k < 30000 && getppid() == parent; ++k) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
      std::ifstream file(entry.path());
      std::string head;
      std::getline(file, head);
      if (head.find(",9]]") == std::string::npos) continue;
      kill(parent, SIGINT);
      _exit(0);
    }
    usleep(1000);
  }
  _exit(1);
}

TEST_F(CampaignTest, WhatWentOnInMoreThreadsIsResumed) {
  run("smoke", {.out = root_ / "a"}, false, "/descend/");
  setenv("PHYSINV_FAKE_PACE_MS", "40", 1);
  const pid_t child = interrupt_when_shared(root_ / "b/checkpoints");
  CampaignOptions options = sharing("b");
  options.checkpoint_seconds = 1e-3;
  const auto first = run("smoke", options, false, "/descend/");
  unsetenv("PHYSINV_FAKE_PACE_MS");
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(first.interrupted);
  EXPECT_EQ(first.not_run.size(), 1U);
  run("smoke", {.out = root_ / "b"}, false, "/descend/");
  EXPECT_EQ(bits(root_ / "a"), bits(root_ / "b"));
  const Results with = load_results(root_ / "b");
  const auto changes =
      with.find("fake/cubic", "descend", 4, 0, "solve")->run.thread_changes;
  EXPECT_EQ(changes.find("9 from iteration "), 0U) << changes;
  EXPECT_NE(changes.find(", 1 from iteration "), std::string::npos) << changes;
}

TEST_F(CampaignTest, ReusesWhatIsFinished) {
  run("smoke", {.out = root_ / "a"});
  const std::string once = bits(root_ / "a");
  const auto again = run("smoke", {.out = root_ / "a"});
  EXPECT_EQ(again.stages_run, 0u);
  EXPECT_EQ(again.stages_reused, 6u);
  ASSERT_EQ(again.origins.size(), 1u);
  EXPECT_EQ(once, bits(root_ / "a"));
  const auto fresh = run("smoke", {.out = root_ / "a", .resume = false});
  // The first stage of walk is that of stroll, so it runs once.
  EXPECT_EQ(fresh.stages_run, 5u);
  EXPECT_EQ(fresh.stages_reused, 1u);
  EXPECT_EQ(once, bits(root_ / "a"));
}

TEST_F(CampaignTest, FreshRunsTheSelectedAgainAndKeepsTheRest) {
  run("smoke", {.out = root_ / "a"});
  const std::string once = bits(root_ / "a");
  const auto files = [&] {
    std::map<std::string, fs::file_time_type> times;
    for (const auto& f : fs::directory_iterator(root_ / "a/cases"))
      times[f.path().filename()] = f.last_write_time();
    return times;
  };
  const auto before = files();
  ASSERT_EQ(before.size(), 4u);
  // Also the first stage, although stroll's is the same.
  const auto fresh =
      run("smoke", {.out = root_ / "a", .resume = false}, false, "/walk/");
  EXPECT_EQ(fresh.stages_run, 2u);
  EXPECT_EQ(fresh.stages_reused, 0u);
  EXPECT_EQ(fresh.cases.size(), 4u);
  EXPECT_EQ(once, bits(root_ / "a"));
  for (const auto& [name, time] : files())
    EXPECT_EQ(time == before.at(name), name.find("walk") == std::string::npos)
        << name;
  const auto catalog = Catalog::read(root_ / "a");
  EXPECT_EQ(catalog.plan.at("cases").size(), 4u);
  EXPECT_EQ(catalog.entries().size(), 6u);
}

TEST_F(CampaignTest, FailuresDoNotStopTheOthers) {
  const auto result = run("bad", {.out = root_ / "a", .jobs = 2});
  EXPECT_EQ(result.failed.size(), 4u);
  const Results results = load_results(root_ / "a");
  const auto* good = results.find("fake/cubic", "descend", 4, 0, "solve");
  ASSERT_NE(good, nullptr);
  EXPECT_EQ(good->stop, Stop::iterations);
  // Failed stages are tried again, finished ones are not.
  const auto again = run("bad", {.out = root_ / "a"});
  EXPECT_EQ(again.stages_reused, 1u);
  EXPECT_EQ(again.failed.size(), 4u);
}

/// Whatever one stage leaves, it is stored or fails alone, and every reader
/// reads what is there.
TEST_F(CampaignTest, WhateverAStageLeavesTheStoreIsRead) {
  std::size_t failed = 0, kept = 0;
  for (int way = 0; way < 40; ++way) {
    SCOPED_TRACE(way);
    setenv("PHYSINV_FAKE_RETURN", std::to_string(way).c_str(), 1);
    const fs::path out = root_ / std::to_string(way);
    const auto result = run("hostile", {.out = out});
    ASSERT_LE(result.failed.size(), 1U);
    failed += result.failed.size();
    const Catalog catalog = Catalog::read(out);
    const auto cases = checked_cases(catalog);
    ASSERT_EQ(cases.size(), 2U);
    const StageRecord& left = cases[0].stages.at(0);
    EXPECT_LE(left.message.size(), kLongestMessage + 100);
    for (Index i = 0; has_result(left) && i < left.loss.size(); ++i) {
      if (std::isfinite(left.loss(i))) continue;
      EXPECT_EQ(left.status[static_cast<std::size_t>(i)], Status::nonfinite);
    }
    kept += has_result(left) ? 1 : 0;
    const auto lacks = missing_work(catalog, cases);
    EXPECT_EQ(lacks.failed.size(), result.failed.size());
    EXPECT_FALSE(tidy_csv(catalog, cases, lacks).empty());
    EXPECT_NO_THROW(read_results(out));
    const auto report = verify_results(Results(cases), registry_);
    EXPECT_TRUE(report.mismatches.empty()) << report.mismatches.front();
    // Other cases continue in the same store.
    if (way % 8 > 0) continue;
    EXPECT_TRUE(run("smoke", {.out = out}).failed.empty());
  }
  EXPECT_GT(failed, 8U);
  EXPECT_GT(kept, 8U);
}

TEST_F(CampaignTest, BudgetActsBetweenCases) {
  const auto result = run("quick", {.out = root_ / "a", .time_budget = 1e-9});
  EXPECT_EQ(result.not_run.size(), 18u);
  EXPECT_FALSE(result.interrupted);
  const auto rest = run("quick", {.out = root_ / "a"});
  EXPECT_TRUE(rest.not_run.empty());
}

}  // namespace
}  // namespace physinv
