#include "suite/store/results_json.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

using nlohmann::json;

CaseRecord sample_record(const std::string& method, Index n) {
  CaseRecord c;
  c.info = sample_case(method, n, 1);
  c.data = sample_data(c.info);
  for (Index k = 0; k < 2; ++k) c.stages.push_back(sample_stage(c.info, k));
  return c;
}

json parsed(const std::vector<CaseRecord>& cases,
            const std::vector<std::string>& order,
            const json& context = {}) {
  return json::parse(results_text(results_json(
      cases, order, context.is_null() ? json::object() : context)));
}

std::string type_of(const json& value) {
  if (value.is_number_float()) return "<number>";
  if (value.is_number()) return "<integer>";
  return fmt::format("<{}>", value.type_name());
}

/// Texts in angle brackets are types, everything else is meant literally; an
/// object of the pattern lists all keys.
void expect_pattern(const json& pattern,
                    const json& value,
                    const std::string& where) {
  if (pattern.is_object()) {
    ASSERT_TRUE(value.is_object()) << where;
    for (const auto& [key, inner] : pattern.items()) {
      ASSERT_TRUE(value.contains(key)) << where << "/" << key;
      expect_pattern(inner, value[key], where + "/" + key);
    }
    for (const auto& [key, inner] : value.items())
      EXPECT_TRUE(pattern.contains(key)) << "new key " << where << "/" << key;
  } else if (pattern.is_array()) {
    ASSERT_EQ(value.size(), pattern.size()) << where;
    for (std::size_t i = 0; i < pattern.size(); ++i)
      expect_pattern(pattern[i], value[i], fmt::format("{}/{}", where, i));
  } else if (pattern.is_string() &&
             pattern.get<std::string>().starts_with("<")) {
    EXPECT_EQ(type_of(value), pattern) << where;
  } else {
    EXPECT_EQ(value, pattern) << where;
  }
}

TEST(ResultsJson, KeysAndTypesAreGolden) {
  auto c = sample_record("jpo", 4);
  for (auto& stage : c.stages) stage.loss = sample_batch(4, 1, 9);
  const json golden = json::parse(
      read_file(std::string(PHYSINV_SOURCE_DIR) + "/tests/golden/record.json"));
  expect_pattern(golden, parsed({c}, {c.info.name}), "");
}

TEST(ResultsJson, OrderIsThePlansNotTheRunners) {
  const auto a = sample_record("bfgs", 4), b = sample_record("jpo", 4);
  const std::vector<std::string> order = {b.info.name, "not run", a.info.name};
  const json one = parsed({a, b}, order), two = parsed({b, a}, order);
  EXPECT_EQ(one, two);
  ASSERT_EQ(one["benchmarks"].size(), 4U);
  EXPECT_EQ(one["benchmarks"][0]["name"], b.info.name + "/fit");
  EXPECT_EQ(one["benchmarks"][3]["family_index"], 2);
  EXPECT_EQ(one["benchmarks"][3]["per_family_instance_index"], 1);
}

TEST(ResultsJson, NumbersThatAreNotFiniteAreNull) {
  auto c = sample_record("jpo", 5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  c.stages[0].loss = Vector<double>{{nan, 3.0, 1e-9, 2.0, nan}};
  c.stages[1].loss = Vector<double>{{nan, nan, nan}};
  const json entries = parsed({c}, {c.info.name})["benchmarks"];
  EXPECT_TRUE(entries[0]["loss_mean"].is_null());
  EXPECT_TRUE(entries[0]["loss_max"].is_null());
  EXPECT_EQ(entries[0]["loss_median"], 3.0);
  EXPECT_EQ(entries[0]["solved_1e-6"], 0.2);
  EXPECT_TRUE(entries[1]["loss_median"].is_null());
  EXPECT_EQ(entries[1]["solved_1e-6"], 0.0);
}

TEST(ResultsJson, StageWithoutLossesHasNoAccuracy) {
  auto c = sample_record("jpo", 4);
  c.stages[0].loss.resize(0);
  c.stages[0].status.clear();
  const json entry = parsed({c}, {c.info.name})["benchmarks"][0];
  EXPECT_TRUE(entry["loss_mean"].is_null());
  EXPECT_TRUE(entry["solved_1e-6"].is_null());
}

TEST(ResultsJson, ContextIsKeptAndCompleted) {
  const auto c = sample_record("jpo", 4);
  const json context = parsed({c},
                              {c.info.name},
                              {{"host_name", "here"},
                               {"physinv", {{"note", "kept"}}},
                               {"options", {{"threads", 7}}}});
  EXPECT_EQ(context["context"]["host_name"], "here");
  EXPECT_EQ(context["context"]["physinv"]["note"], "kept");
  EXPECT_EQ(context["context"]["physinv"]["schema_version"], 2);
  EXPECT_EQ(context["context"]["num_cpus"], 0);
}

TEST(ResultsJson, StagesTellTheirOwnRun) {
  auto c = sample_record("jpo", 4);
  c.info.profile = "quick";
  c.stages[0].run = {.profile = "smoke",
                     .host = "there",
                     .processor = "p",
                     .instruction_set = "i",
                     .threads = 5,
                     .jobs = 2};
  c.stages[1].run = {};  // of an older version
  const json entries = parsed({c}, {c.info.name})["benchmarks"];
  EXPECT_EQ(entries[0]["threads"], 5);
  EXPECT_EQ(entries[0]["physinv"]["profile"], "smoke");
  EXPECT_EQ(entries[0]["physinv"]["timed_on"],
            (json{{"host_name", "there"},
                  {"cpu_model", "p"},
                  {"instruction_set", "i"},
                  {"threads", 5},
                  {"jobs", 2}}));
  EXPECT_EQ(entries[1]["threads"], 1);
  EXPECT_EQ(entries[1]["physinv"]["profile"], "quick");
  EXPECT_TRUE(entries[1]["physinv"]["timed_on"].is_null());
}

TEST(ResultsJson, TimesAreTheMedianOfAllRuns) {
  auto c = sample_record("jpo", 4);
  c.stages[0].clocks.solve = {9e-3, 8e-3};  // cold
  c.stages[0].repeated = {{2e-3, 1e-3}, {3e-3, 2e-3}};
  const json entry = parsed({c}, {c.info.name})["benchmarks"][0];
  EXPECT_DOUBLE_EQ(entry["real_time"], 3e6);
  EXPECT_DOUBLE_EQ(entry["cpu_time"], 2e6);
  EXPECT_EQ(entry["repetitions"], 3);
  EXPECT_EQ(entry["physinv"]["times"]["wall"].size(), 3U);
  EXPECT_DOUBLE_EQ(entry["physinv"]["times"]["wall"][0], 9e6);
}

TEST(ResultsJson, WhatEndedWithoutAResultHasNoNumbers) {
  for (const Stop stop : {Stop::diverged, Stop::failed, Stop::skipped}) {
    auto c = sample_record("jpo", 4);
    c.stages[0].stop = stop;
    c.stages[0].message = "says why";
    const json entry = parsed({c}, {c.info.name})["benchmarks"][0];
    EXPECT_EQ(entry["error_occurred"], true);
    EXPECT_EQ(entry["error_message"],
              std::string(to_string(stop)) + ": says why");
    for (const auto& [key, value] : entry.items())
      EXPECT_TRUE(!value.is_number() || key.ends_with("_index")) << key;
    EXPECT_TRUE(entry["physinv"]["times"].is_null());
    EXPECT_EQ(entry["physinv"]["setup_ms"].is_null(), stop != Stop::diverged);
  }
}

}  // namespace
}  // namespace physinv
