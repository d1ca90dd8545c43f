// The program itself, run in every way that must not matter: workers, threads,
// shards, order, interruption. Records and arrays are equal to the last bit.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "suite/results/results.h"
#include "tests/support/bits.h"

namespace physinv::test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// The smoke profile with every method at two sizes and seeds.
const Words kCampaign = {"--profile=smoke",
                         "--filter=^jpo/billiards/",
                         "--set",
                         "n=4,33",
                         "--set",
                         "iterations=200",
                         "--seeds=0,1",
                         "--trace"};

class BilliardsBits : public testing::Test {
 protected:
  BilliardsBits() {
    std::string pattern = (fs::temp_directory_path() / "bitsXXXXXX").string();
    root_ = mkdtemp(pattern.data());
  }
  ~BilliardsBits() override { fs::remove_all(root_); }

  static pid_t start(const Words& words) {
    const pid_t child = fork();
    if (child != 0) return child;
    std::freopen("/dev/null", "w", stdout);
    std::vector<char*> arguments;
    Words all = {PHYSINV_BENCH};
    all.insert(all.end(), words.begin(), words.end());
    for (auto& word : all) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(PHYSINV_BENCH, arguments.data());
    _exit(127);
  }
  static int finish(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  static int bench(const Words& words) { return finish(start(words)); }

  Words campaign(const std::string& out, const Words& more = {}) const {
    Words words = {"run", "--out=" + (root_ / out).string()};
    words.insert(words.end(), kCampaign.begin(), kCampaign.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  void run(const std::string& out, const Words& more = {}) const {
    ASSERT_EQ(bench(campaign(out, more)), 0) << out;
  }

  /// results.json without time, place and way.
  nlohmann::json summary(const std::string& out) const {
    std::ifstream file(root_ / out / "results.json");
    auto all = nlohmann::json::parse(file).at("benchmarks");
    std::map<std::string, nlohmann::json> by_name;
    for (const auto& entry : all) by_name[entry.at("name")] = cleaned(entry);
    return by_name;
  }
  static nlohmann::json cleaned(nlohmann::json value) {
    if (!value.is_structured()) return value;
    if (value.is_object()) {
      for (const char* key : {"real_time",
                              "cpu_time",
                              "setup_ms",
                              "warmup_ms",
                              "data_ms",
                              "measure_ms",
                              "times",
                              "timed_on",
                              "peak_buffer_bytes",
                              "rss_bytes",
                              "crowded",
                              "finished",
                              "threads"})
        value.erase(key);
    }
    for (auto& part : value) part = cleaned(part);
    return value;
  }

  void expect_equal(const std::string& a, const std::string& b) const {
    SCOPED_TRACE(a + " and " + b);
    const Results first = load_results(root_ / a);
    const Results second = load_results(root_ / b);
    ASSERT_EQ(first.cases().size(), second.cases().size());
    for (const CaseRecord& c : first.cases()) {
      const CaseRecord* d = second.find_case(
          c.info.experiment, c.info.method, c.info.n, c.info.seed);
      ASSERT_NE(d, nullptr) << c.info.name;
      EXPECT_EQ(c.data.hash, d->data.hash);
      EXPECT_TRUE(same_bits(c.data.x, d->data.x));
      EXPECT_TRUE(same_bits(c.data.y, d->data.y));
      EXPECT_TRUE(same_bits(c.data.given, d->data.given));
      ASSERT_EQ(c.stages.size(), d->stages.size());
      for (std::size_t i = 0; i < c.stages.size(); ++i) {
        EXPECT_FALSE(c.stages[i].trajectory.empty());
        expect_same(c.stages[i], d->stages[i]);
      }
    }
    EXPECT_EQ(summary(a), summary(b));
  }

  std::size_t stages(const std::string& out) const {
    std::ifstream journal(root_ / out / "journal.jsonl");
    std::size_t lines = 0;
    for (std::string line; std::getline(journal, line);) ++lines;
    return lines == 0 ? 0 : lines - 1;
  }

  fs::path root_;
};

TEST_F(BilliardsBits, WorkersAndThreads) {
  run("one", {"--jobs=1", "--threads=1"});
  const Results results = load_results(root_ / "one");
  EXPECT_EQ(results.methods("jpo/billiards").size(), 5U);
  run("two", {"--jobs=2", "--threads=1"});
  run("seven", {"--jobs=7", "--threads=1"});
  run("threads", {"--jobs=1", "--threads=2"});
  for (const char* other : {"two", "seven", "threads"})
    expect_equal("one", other);
}

TEST_F(BilliardsBits, ShardsAndOrder) {
  run("one", {"--jobs=2"});
  for (const char* part : {"1", "2", "3"})
    run(part, {"--jobs=2", std::string("--shard=") + part + "/3"});
  const auto at = [&](const char* name) { return (root_ / name).string(); };
  ASSERT_EQ(bench({"merge", at("merged"), at("1"), at("2"), at("3")}), 0);
  expect_equal("one", "merged");

  // The same cases, asked for one method at a time, last methods first.
  for (const char* method : {"na", "supervised", "jpo", "gd", "bfgs"}) {
    Words words = campaign("reversed", {"--jobs=2"});
    words[3] = std::string("--filter=^jpo/billiards/") + method + "/";
    ASSERT_EQ(bench(words), 0);
  }
  run("reversed");  // nothing is left to do
  expect_equal("one", "reversed");
}

TEST_F(BilliardsBits, InterruptedAndResumed) {
  run("one", {"--jobs=2"});
  const std::size_t whole = stages("one");
  ASSERT_GT(whole, 10U);
  std::size_t midway = 0;
  for (const int signal : {SIGINT, SIGKILL, SIGTERM}) {
    const std::string out = "stopped" + std::to_string(signal);
    // Finished stages go to the disk as often as that.
    const pid_t child = start(campaign(out, {"--jobs=1", "--checkpoint=0.02"}));
    for (int i = 0; i < 5000 && stages(out) < 4 * (midway + 1); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(child, signal);
    finish(child);
    midway += stages(out) < whole;
    run(out, {"--jobs=2"});
    EXPECT_EQ(stages(out), whole);
    expect_equal("one", out);
  }
  EXPECT_GT(midway, 0U);
}

}  // namespace
}  // namespace physinv::test
