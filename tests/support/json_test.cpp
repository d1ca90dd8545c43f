#include "tests/support/json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace physinv::test {
namespace {

Json parsed_json(const char* text) { return Json(Json::Raw::parse(text)); }

/// What reading throws.
template <class F>
std::string refusal(F&& read) {
  try {
    read();
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "nothing";
}

TEST(ReferenceJson, WordsAreNumbersThatJsonLacks) {
  const Json list = parsed_json(R"([1, 2.5, "inf", "-inf", "nan", null])");
  const std::vector<double> read = list;
  constexpr double kInf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(read[0], 1);
  EXPECT_EQ(read[1], 2.5);
  EXPECT_EQ(read[2], kInf);
  EXPECT_EQ(read[3], -kInf);
  EXPECT_TRUE(std::isnan(read[4]));
  EXPECT_TRUE(std::isnan(read[5]));
}

TEST(ReferenceJson, WhatIsOfAnotherTypeIsNamed) {
  const Json entry = parsed_json(
      R"({"inputs": {"n": 2.5, "rate": "fast", "xi": [[1, 2, 3]]}})");
  const Json in = entry.at("inputs");
  EXPECT_EQ(refusal([&] { (void)in.at("n").get<int>(); }),
            "inputs.n is 2.5, expected an integer");
  EXPECT_EQ(refusal([&] { (void)in.at("rate").get<double>(); }),
            "inputs.rate is \"fast\", expected a number");
  EXPECT_EQ(refusal([&] { (void)in.at("xi")[0].get<std::array<double, 2>>(); }),
            "inputs.xi[0] is [1,2,3], expected a list of 2");
  EXPECT_EQ(refusal([&] { (void)in.at("xi")[1]; }),
            "inputs.xi is [[1,2,3]], expected a list of more than 1");
  EXPECT_EQ(refusal([&] { (void)in.at("lr"); }), "no key lr in inputs");
  EXPECT_EQ(refusal([&] { (void)entry.at("expected"); }), "no key expected");
  EXPECT_EQ(in.at("xi")[0][1].get<int>(), 2);
  EXPECT_EQ(parsed_json("12.0").get<int>(), 12);
  EXPECT_THROW((void)parsed_json("1e24").get<int>(), std::runtime_error);
}

TEST(ReferenceJson, RemembersWhatIsRead) {
  const Json entry = parsed_json(R"({
      "description": "for people", "inputs": {"a": 1, "b": 2},
      "steps": [{"x": 1, "why": "so"}, {"x": 2, "y": 3}], "rtol": 1})");
  EXPECT_EQ(entry.unread(),
            (std::vector<std::string>{"inputs", "rtol", "steps"}));
  (void)entry.at("inputs").at("a");
  (void)entry.value("rtol", 0.0);
  for (const Json& step : entry.at("steps")) (void)step.at("x");
  EXPECT_EQ(entry.unread(),
            (std::vector<std::string>{"inputs.b", "steps[1].y"}));
  EXPECT_FALSE(entry.contains("y"));
  EXPECT_EQ(entry.at("inputs").value("c", 7), 7);
}

}  // namespace
}  // namespace physinv::test
