#include "suite/store/merge.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "suite/results/results.h"
#include "suite/store/store.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

using nlohmann::json;

class MergeTest : public testing::Test {
 protected:
  MergeTest() {
    for (const auto* method : {"na", "bfgs", "jpo"})
      for (std::uint64_t seed = 0; seed < 2; ++seed)
        cases_.push_back(sample_case(method, 4, seed));
    for (const auto& info : cases_) names_.push_back(info.name);
  }

  /// Runs the cases for which `mine` holds, the last one first.
  template <class F>
  void run(const std::string& where,
           F&& mine,
           std::uint64_t times = 0,
           const std::string& fingerprint = "f",
           const std::string& recipe = "r") {
    Store store(out_ / where);
    std::vector<PlannedCase> campaign;
    for (const auto& name : names_) campaign.push_back({name, recipe});
    std::vector<CaseInfo> chosen;
    for (std::size_t i = 0; i < cases_.size(); ++i)
      if (mine(i)) chosen.push_back(cases_[i]);
    store.set_plan(chosen, {{"fingerprint", fingerprint}}, campaign);
    for (auto c = chosen.rbegin(); c != chosen.rend(); ++c)
      for (Index k = 0; k < 2; ++k)
        store.append(*c, sample_data(*c), sample_stage(*c, k, times));
    store.finish();
  }

  json results(const std::string& where) {
    return json::parse(read_file(out_ / where / "results.json"));
  }

  TemporaryDirectory out_;
  std::vector<CaseInfo> cases_;
  std::vector<std::string> names_;
};

bool even(std::size_t i) { return i % 2 == 0; }
bool odd(std::size_t i) { return i % 2 == 1; }
bool all(std::size_t) { return true; }

TEST_F(MergeTest, EqualsTheUnshardedRun) {
  run("whole", all), run("even", even), run("odd", odd);
  const auto merged_all = merge({out_ / "odd", out_ / "even"}, out_ / "merged");
  EXPECT_FALSE(merged_all.lacks.any());
  EXPECT_EQ(results("merged"), results("whole"));
  const auto whole = load_results(out_ / "whole");
  const auto merged = load_results(out_ / "merged");
  ASSERT_EQ(whole.cases().size(), 6U);
  ASSERT_EQ(merged.cases().size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(merged.cases()[i].info.name, names_[i]);
    for (std::size_t k = 0; k < 2; ++k)
      expect_same(whole.cases()[i].stages[k], merged.cases()[i].stages[k]);
  }
}

TEST_F(MergeTest, CanBeRepeated) {
  run("even", even), run("odd", odd);
  EXPECT_EQ(merge({out_ / "odd"}, out_ / "merged").lacks.unrun_cases,
            (std::vector{names_[0], names_[2], names_[4]}));
  EXPECT_FALSE(
      merge({out_ / "odd", out_ / "even"}, out_ / "merged").lacks.any());
  EXPECT_EQ(results("merged")["benchmarks"].size(), 12U);
}

TEST_F(MergeTest, SameStageTwiceMayDifferInTimesOnly) {
  run("a", all, 0), run("b", all, 1);
  EXPECT_NO_THROW(merge({out_ / "a", out_ / "b"}, out_ / "merged"));

  Store other(out_ / "c");
  other.set_plan(cases_, {{"fingerprint", "f"}});
  auto stage = sample_stage(cases_[2], 1);
  stage.x(0, 0) += 1e-16 + stage.x(0, 0);
  other.append(cases_[2], sample_data(cases_[2]), stage);
  const auto message = message_of<UnreadableInput>([&] {
    merge({out_ / "a", out_ / "c"}, out_ / "wrong");
  });
  EXPECT_TRUE(contains(message, (out_ / "a").string())) << message;
  EXPECT_TRUE(contains(message, (out_ / "c").string())) << message;
  EXPECT_TRUE(contains(message, cases_[2].name)) << message;
}

/// A shard of x86-64 and one of aarch64: machine and build of a plan and of
/// records are kept, and decide nothing.
TEST_F(MergeTest, ShardsOfTwoProcessorsAreOneCampaign) {
  run("whole", all);
  const auto part = [&](const std::string& where, std::size_t first, json on) {
    Store store(out_ / where);
    std::vector<PlannedCase> campaign;
    for (const auto& name : names_) campaign.push_back({name, "r"});
    std::vector<CaseInfo> chosen;
    for (std::size_t i = first; i < cases_.size(); i += 2)
      chosen.push_back(cases_[i]);
    on["fingerprint"] = "f";
    store.set_plan(chosen, on, campaign);
    for (const auto& c : chosen)
      for (Index k = 0; k < 2; ++k) {
        StageRecord stage = sample_stage(c, k);
        stage.run.instruction_set = on.at("instruction_set");
        stage.run.processor = on.at("cpu_model");
        store.append(c, sample_data(c), stage);
      }
    store.finish();
  };
  part("x86",
       0,
       {{"instruction_set", "x86-64-v4"},
        {"cpu_model", "AMD EPYC"},
        {"compiler", "GNU 12.2.0"},
        {"mhz_per_cpu", 2400}});
  part("arm",
       1,
       {{"instruction_set", "aarch64"},
        {"cpu_model", "ARM Neoverse-N1"},
        {"compiler", "Clang 14.0.6"},
        {"mhz_per_cpu", 0}});
  EXPECT_FALSE(
      merge({out_ / "arm", out_ / "x86"}, out_ / "merged").lacks.any());
  const auto whole = load_results(out_ / "whole");
  const auto merged = load_results(out_ / "merged");
  ASSERT_EQ(merged.cases().size(), cases_.size());
  for (std::size_t i = 0; i < cases_.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const StageRecord& stage = merged.cases()[i].stages[k];
      EXPECT_EQ(results_hash(stage), results_hash(whole.cases()[i].stages[k]));
      EXPECT_EQ(stage.key, cases_[i].keys[k]);
      EXPECT_EQ(stage.run.instruction_set, i % 2 ? "aarch64" : "x86-64-v4");
    }
}

TEST_F(MergeTest, OtherBuildIsRefused) {
  run("even", even), run("odd", odd, 0, "g");
  const auto message = message_of<UnreadableInput>([&] {
    merge({out_ / "even", out_ / "odd"}, out_ / "merged");
  });
  EXPECT_TRUE(contains(message, "fingerprint, \"f\" and \"g\"")) << message;
  EXPECT_FALSE(std::filesystem::exists(out_ / "merged"));
}

TEST_F(MergeTest, OtherCampaignIsRefused) {
  run("even", even);
  names_.pop_back();
  run("odd", odd);
  EXPECT_THROW(merge({out_ / "even", out_ / "odd"}, out_ / "merged"),
               UnreadableInput);
}

TEST_F(MergeTest, OtherOptionsAreRefused) {
  run("even", even), run("odd", odd, 0, "f", "of five iterations");
  const auto message = message_of<UnreadableInput>([&] {
    merge({out_ / "even", out_ / "odd"}, out_ / "merged");
  });
  EXPECT_TRUE(contains(message, "with different options")) << message;
  EXPECT_TRUE(contains(message, (out_ / "odd").string())) << message;
  EXPECT_FALSE(std::filesystem::exists(out_ / "merged"));
}

TEST_F(MergeTest, OtherOptionsOfOldPlansAreRefused) {
  run("even", even), run("odd", odd);
  for (const char* where : {"even", "odd"}) {
    const auto path = out_ / where / "plan.json";
    json plan = json::parse(read_file(path));
    for (const char* key : {"checksum", "recipes", "keys"}) plan.erase(key);
    plan["schema_version"] = 1;
    plan["context"]["options"]["set"] =
        std::string(where) == "odd" ? json({"iterations=5"}) : json::array();
    write_file(path, plan.dump());
  }
  const auto message = message_of<UnreadableInput>([&] {
    merge({out_ / "even", out_ / "odd"}, out_ / "merged");
  });
  EXPECT_TRUE(contains(message, "iterations=5")) << message;
}

TEST_F(MergeTest, OtherContentKeysAreRefused) {
  run("a", all);
  cases_[3].keys[0] = hex128("of other data");
  run("b", all);
  const auto message = message_of<UnreadableInput>([&] {
    merge({out_ / "a", out_ / "b"}, out_ / "merged");
  });
  EXPECT_TRUE(contains(message, names_[3])) << message;
}

TEST_F(MergeTest, StagesOutsideThePlanStayOut) {
  run("even", even);
  const auto keys = cases_[1].keys;
  cases_[1].keys = {hex128("earlier fit"), hex128("earlier refine")};
  run("odd", odd);
  cases_[1].keys = keys;  // planned again with other options, and not run
  std::vector<PlannedCase> campaign;
  for (const auto& name : names_) campaign.push_back({name, "r"});
  Store(out_ / "odd")
      .set_plan(
          {cases_[1], cases_[3], cases_[5]}, {{"fingerprint", "f"}}, campaign);
  const auto merged = merge({out_ / "even", out_ / "odd"}, out_ / "merged");
  EXPECT_EQ(merged.lacks.unrun_cases, std::vector{names_[1]});
  EXPECT_EQ(results("merged")["benchmarks"].size(), 10U);
}

TEST_F(MergeTest, ACampaignIsNoPlaceToMergeInto) {
  run("even", even), run("odd", odd);
  const auto before = read_file(out_ / "even" / "journal.jsonl");
  for (const auto& shards :
       {std::vector{out_ / "odd"}, std::vector{out_ / "even", out_ / "odd"}}) {
    const auto message =
        message_of<UnreadableInput>([&] { merge(shards, out_ / "even"); });
    EXPECT_TRUE(contains(message, "OUT")) << message;
  }
  EXPECT_EQ(read_file(out_ / "even" / "journal.jsonl"), before);
}

TEST_F(MergeTest, LostArraysOfAShardAreNamed) {
  run("even", even), run("odd", odd);
  std::filesystem::remove(Catalog(out_ / "odd").case_path(names_[1]));
  const auto merged = merge({out_ / "even", out_ / "odd"}, out_ / "merged");
  ASSERT_EQ(merged.warnings.size(), 2U);
  EXPECT_TRUE(contains(merged.warnings[0], names_[1] + " fit are missing"));
  EXPECT_EQ(merged.lacks.unrun_cases, std::vector{names_[1]});
}

TEST_F(MergeTest, EmptyShardIsFine) {
  run("whole", all), run("none", [](std::size_t) { return false; });
  merge({out_ / "none", out_ / "whole"}, out_ / "merged");
  EXPECT_EQ(results("merged"), results("whole"));
}

}  // namespace
}  // namespace physinv
