#include "suite/store/json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "suite/store/checksum.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

TEST(Checksum, AgreesWithPublishedVectors) {
  EXPECT_EQ(crc32c(""), 0U);
  EXPECT_EQ(crc32c("123456789"), 0xe3069283U);            // RFC 3720's CRC
  EXPECT_EQ(crc32c(std::string(32, '\0')), 0x8a9136aaU);  // RFC 3720, B.4
}

TEST(Json, WireKeepsEveryBit) {
  const auto record = sample_stage(sample_case("jpo", 6, 1), 1);
  expect_same(record, from_wire(to_wire(record)));
}

TEST(Json, WireRejectsGarbage) {
  auto bytes = to_wire(sample_stage(sample_case("jpo", 2, 1), 0));
  bytes.resize(bytes.size() / 2);
  EXPECT_THROW(from_wire(bytes), std::exception);
}

TEST(Json, ScalarsRoundTripAsText) {
  auto record = sample_stage(sample_case("jpo", 4, 1), 0);
  record.stop = Stop::diverged;
  const auto text = to_json(record).dump();
  auto back = stage_from_json(nlohmann::json::parse(text));
  back.x = record.x, back.loss = record.loss, back.status = record.status;
  back.example_iterations = record.example_iterations;
  back.example_evaluations = record.example_evaluations;
  back.curve = record.curve, back.arrays = record.arrays;
  expect_same(record, back);
}

TEST(Json, CountersThatARecordLacksAreNotZero) {
  auto record = sample_stage(sample_case("jpo", 4, 1), 0);
  EXPECT_TRUE(record.counts.knows(Counter::skipped_levels));
  auto json = to_json(record);
  json["counts"].erase("skipped_levels");
  auto old = stage_from_json(json).counts;
  EXPECT_FALSE(old.knows(Counter::skipped_levels));
  EXPECT_TRUE(old.knows(Counter::skipped_rows));
  record.counts += old;  // nor is the sum known
  EXPECT_FALSE(record.counts.knows(Counter::skipped_levels));
  json = to_json(record);
  EXPECT_FALSE(json["counts"].contains("skipped_levels"));
  EXPECT_EQ(json["counts"]["skipped_rows"], 6);
  EXPECT_EQ(stage_from_json(json).counts, record.counts);
}

TEST(Json, CountersKeepTheirOrderAndWhatIsNotCounted) {
  Counts counts;
  counts[Counter::forward] = 3;
  counts[Counter::abandoned_levels] = 2;
  counts.forget(Counter::vjp);
  auto object = nlohmann::ordered_json::object();
  add_counts(object, counts);
  EXPECT_EQ(object.size(), kCounters - 1);
  EXPECT_TRUE(
      object.dump().starts_with(R"({"forward":3,"jacobian":0,"inverse":0,)"));
  EXPECT_EQ(counts_from_json(object), counts);
}

TEST(Json, NoCountersAreKnownWhereNoneWereKept) {
  const Counts counts = counts_from_json(nullptr);
  for (std::size_t i = 0; i < kCounters; ++i)
    EXPECT_FALSE(counts.knows(static_cast<Counter>(i))) << kCounterNames[i];
}

TEST(Json, CountersAreNoFractions) {
  for (const auto& bad : nlohmann::json::array({-1, 0.5, "3", nullptr}))
    EXPECT_THROW(counts_from_json({{"forward", bad}}), std::exception) << bad;
}

TEST(Json, CaseRoundTrips) {
  auto info = sample_case("na", 128, ~0ULL);
  info.precision = Precision::f64;
  const auto back = case_from_json(nlohmann::json::parse(to_json(info).dump()));
  EXPECT_EQ(back.name, info.name);
  EXPECT_EQ(back.n, info.n);
  EXPECT_EQ(back.seed, info.seed);
  EXPECT_EQ(back.precision, info.precision);
  EXPECT_EQ(back.stages, info.stages);
  EXPECT_EQ(back.keys, info.keys);
}

}  // namespace
}  // namespace physinv
