#include "tests/support/reference.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/support/hig_reference.h"

namespace physinv::test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Json parsed(const char* text) { return Json(Json::Raw::parse(text)); }

/// A folder of one file, to which the environment points the tests.
class OtherFolder : public testing::Test {
 protected:
  void write(const std::string& text) {
    std::filesystem::create_directories(dir_);
    std::ofstream(dir_ / "some.json") << text;
    setenv("PHYSINV_REFERENCE_DIR", dir_.c_str(), 1);
  }
  void SetUp() override {
    const char* before = std::getenv("PHYSINV_REFERENCE_DIR");
    if (before != nullptr) before_ = before;
  }
  void TearDown() override {
    setenv("PHYSINV_REFERENCE_DIR", before_.c_str(), 1);
    std::filesystem::remove_all(dir_);
  }

 private:
  std::filesystem::path dir_ =
      std::filesystem::path(testing::TempDir()) /
      ("physinv_reference_test_" + std::to_string(getpid()));
  std::string before_;
};

TEST_F(OtherFolder, EveryEntryRunsTheCheckOfItsName) {
  write(R"({"entries": [{"name": "a", "n": 1}, {"name": "b-1", "n": 2},
                        {"name": "b-2", "n": 3}, {"name": "c"}]})");
  std::vector<int> seen;
  const auto read = [&](const Json& e) { seen.push_back(e.at("n")); };
  check_entries("some", {{"a", read}, {"b-*", read}}, {"c"});
  EXPECT_EQ(seen, (std::vector{1, 2, 3}));
  // Another folder need not have all of them.
  check_entries("some", {{"a", read}, {"d", read}}, {"b-*", "c"});
  EXPECT_EQ(spoken_of("some", "b").at("n").get<int>(), 2);
  EXPECT_EQ(spoken_of("some", "b-2").at("n").get<int>(), 3);
}

TEST_F(OtherFolder, WhatNobodyReadsIsAFailure) {
  write(R"({"entries": [{"name": "a", "rate": {"x": 1, "y": 2}}]})");
  const auto read = [](const Json& e) { (void)e.at("rate").at("x"); };
  EXPECT_NONFATAL_FAILURE(check_entries("some", {{"a", read}}),
                          "no test reads rate.y");
  EXPECT_NONFATAL_FAILURE(check_entries("some",
                                        {{"a",
                                          [](const Json& e) {
                                            (void)e.at("rate").items();
                                            (void)e.at("beta");
                                          }}}),
                          "no key beta");
}

TEST_F(OtherFolder, EntriesWithoutTestAndTestsWithoutEntryAreFailures) {
  write(R"({"entries": [{"name": "a"}, {"name": "b"}]})");
  const auto nothing = [](const Json&) {};
  EXPECT_NONFATAL_FAILURE(check_entries("some", {{"a", nothing}}),
                          "no test reads this entry");
  EXPECT_NONFATAL_FAILURE(check_entries("some", {{"c", nothing}}, {"a", "b"}),
                          "some has no entry for this test");
  EXPECT_NONFATAL_FAILURE(expect_known_entries("some", {"a"}),
                          "no test reads the entry b");
}

TEST_F(OtherFolder, ShiftsAndBatchesOfOtherEntries) {
  write(R"({"entries": [
      {"name": "a", "shift": 0.5, "inputs": {"y": [[1, 2]]}},
      {"name": "b"}, {"name": "c", "shift": 2}]})");
  EXPECT_EQ(formula_shift("some", spoken_of("some", "b")), 0.5);
  EXPECT_EQ(formula_shift("some", spoken_of("some", "c")), 2);
  EXPECT_EQ(batch_of("some", parsed(R"("the batch of a")"), "y").dump(),
            "[[1,2]]");
  EXPECT_EQ(batch_of("some", parsed("[[3]]"), "y").dump(), "[[3]]");
  EXPECT_THROW(batch_of("some", parsed(R"("some numbers")"), "y"),
               std::runtime_error);
}

TEST(Reference, SettingsOfInputsDescriptionAndSpecification) {
  const Json entry = parsed(R"({
      "description": "MLP 4-8-2 (1,250 parameters), lr 2e-3, r=0.25",
      "inputs": {"eta": 3}})");
  EXPECT_EQ(setting(entry, "eta", "lr ", 1), 3);
  EXPECT_EQ(setting(entry, "lr", "lr ", 1), 2e-3);
  EXPECT_EQ(setting(entry, "radius", "\\br", 1), 0.25);
  EXPECT_EQ(setting(entry, "decay", "decay", 0.9), 0.9);
  EXPECT_EQ(layer_sizes(entry, {1, 1}), (std::vector<Index>{4, 8, 2}));
  EXPECT_EQ(layer_sizes(parsed("{}"), {1, 1}), (std::vector<Index>{1, 1}));
  expect_parameters(entry, 1250);
  EXPECT_NONFATAL_FAILURE(expect_parameters(entry, 1251), "parameters");
}

TEST(Reference, ListsOfUnequalLengthAreNamed) {
  EXPECT_THROW(columns(parsed("[[1, 2], [3]]")), std::runtime_error);
  EXPECT_THROW(fields(parsed("[[[1], [2]], [[3]]]")), std::runtime_error);
  EXPECT_EQ(field(parsed("[[1, 2], [3, 4]]")), Eigen::Vector4d(1, 2, 3, 4));
}

// Squares of 1e-170 are 0, those of 1e170 infinite.
TEST(Reference, TwoNormsOfVerySmallAndLargeNumbers) {
  for (const double size : {1e-170, 1.0, 1e170}) {
    const Vector<double> a = Vector<double>::Constant(3, size);
    EXPECT_TRUE(TwoNorm(1e-12, 0)(a, a));
    EXPECT_TRUE(TwoNorm(1e-2, 0)(a * 1.001, a)) << size;
    EXPECT_FALSE(TwoNorm(1e-4, 0)(a * 1.001, a)) << size;
  }
}

TEST(Reference, NumbersThatAreNotFiniteEqualTheirKind) {
  const Vector<double> a{{1, kInf, -kInf, kNan}};
  EXPECT_TRUE(TwoNorm(1e-12, 0)(a, a));
  EXPECT_TRUE(Comparator(1e-12, 0)(a, a));
  for (Index i = 0; i < a.size(); ++i)
    for (const double other : {2.0, kInf, -kInf, kNan}) {
      Vector<double> b = a;
      b(i) = other;
      const bool same = a(i) == other || (i == 3 && std::isnan(other));
      EXPECT_EQ(bool(TwoNorm(1e-12, 1e-12)(b, a)), same) << i << ' ' << other;
      EXPECT_EQ(bool(TwoNorm(1e-12, 1e-12)(a, b)), same) << i << ' ' << other;
      EXPECT_EQ(bool(Comparator(1e-12, 0)(b, a)), same) << i << ' ' << other;
    }
}

}  // namespace
}  // namespace physinv::test
