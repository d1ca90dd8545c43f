// One list of what the limit is: what it accepts is read back, and what it
// refuses is refused by readers.
#include "suite/store/storable.h"

#include <gtest/gtest.h>

#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const CaseInfo kInfo = sample_case("jpo", 4, 3);

/// Why a record that was written is not read; empty if it is, bit by bit.
std::string read_back(const StageRecord& record) {
  const std::string hash = hex64(arrays_hash(record));
  StageRecord back = record;
  back.x.resize(0, 0), back.arrays.clear(), back.status.clear();
  try {
    CaseFile file(kInfo.name);
    file.put_data(sample_data(kInfo));
    file.put_stage(record, hash);
    CaseFile(file.bytes(), "path", kInfo.name).read_stage(back, hash);
  } catch (const StoreError& error) {
    return error.what();
  }
  expect_same(record, back);
  return "";
}

/// One thing of a record changed.
using Change = void (*)(StageRecord&);

TEST(Storable, WhatTheListRefusesReadersRefuse) {
  const std::pair<const char*, Change> wrong[] = {
      {"status has 3", [](StageRecord& r) { r.status.pop_back(); }},
      {"iterations has 5",
       [](StageRecord& r) { r.example_iterations.setZero(5); }},
      {"x has 5", [](StageRecord& r) { r.x.setZero(2, 5); }},
      {"curve/seconds has 6",
       [](StageRecord& r) { r.curve.seconds.push_back(1); }},
      {"status contains 9",
       [](StageRecord& r) { r.status[1] = static_cast<Status>(9); }},
      {"iterations contains",
       [](StageRecord& r) { r.example_iterations(2) = kNan; }},
      {"evaluations contains",
       [](StageRecord& r) { r.example_evaluations(2) = -1; }},
      {"curve/iteration contains",
       [](StageRecord& r) { r.curve.iteration[1] = kInfinity; }},
      {"loss contains", [](StageRecord& r) { r.stop = Stop::converged; }},
      {"x contains", [](StageRecord& r) { r.x(0, 3) = kNan; }},
      {"invalid name",
       [](StageRecord& r) { r.arrays[ArrayKey::own("a/b")].setZero(1, 1); }},
      {"invalid name",
       [](StageRecord& r) { r.arrays[ArrayKey::own("")].setZero(1, 1); }},
      {"invalid name", [](StageRecord& r) {
         r.arrays[ArrayKey::own(std::string_view("n\0l", 3))].setZero(1, 1);
       }}};
  for (const auto& [flaw, change] : wrong) {
    StageRecord record = sample_stage(kInfo, 0);
    EXPECT_EQ(flaw_of(record), "");
    change(record);
    EXPECT_TRUE(contains(flaw_of(record), flaw)) << flaw_of(record);
    EXPECT_NE(read_back(record), "") << flaw;
  }
}

TEST(Storable, WhatTheListTakesIsReadBack) {
  const double numbers[] = {kNan, kInfinity, -kInfinity, 1e308, 5e-324, -0.0};
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    StageRecord r = sample_stage(kInfo, 0, seed);
    auto pick = [k = seed * 1000](std::uint64_t count) mutable {
      return static_cast<Index>(mix64(++k) % count);
    };
    for (Batch<double>* array : {&r.x, &r.curve.loss, &r.curve.x})
      for (Index k = pick(4); k-- > 0;)
        array->data()[pick(8)] = numbers[pick(6)];
    for (Index k = pick(4); k-- > 0;) r.loss(pick(4)) = numbers[pick(6)];
    r.stop = static_cast<Stop>(pick(3));
    auto& array = r.arrays[ArrayKey::own(std::string(1 + 999 * pick(2), 'n'))];
    const double value = numbers[pick(6)];
    const Index columns = pick(3);
    array.setConstant(pick(3), columns, value);
    r.buffer_bytes = ~std::uint64_t{0};
    const std::string flaw = flaw_of(r), read = read_back(r);
    EXPECT_EQ(flaw.empty(), read.empty()) << seed << ": " << flaw << read;
  }
}

TEST(Storable, ACasesFileIsNotLargerThanIsRead) {
  StageRecord r = sample_stage(kInfo, 0);
  EXPECT_EQ(flaw_of_new(r, 2), "");
  r.arrays[ArrayKey::own("large")].resize(1, Index{25} << 20);
  EXPECT_TRUE(contains(flaw_of_new(r, 2), "the limit is")) << "of 200 MiB";
  EXPECT_EQ(flaw_of(r), "") << "who has read it has read it";
}

TEST(Storable, AMessageWithoutEndIsCut) {
  EXPECT_EQ(bounded_message("short"), "short");
  const std::string mebibyte(1 << 20, 'm');
  EXPECT_EQ(bounded_message(mebibyte), mebibyte);
  EXPECT_EQ(bounded_message(mebibyte + "12345"),
            mebibyte + " ... (5 bytes left out)");
}

}  // namespace
}  // namespace physinv
