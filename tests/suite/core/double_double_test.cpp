#include "suite/core/double_double.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "suite/core/rng.h"

namespace physinv {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

DoubleDouble sin(DoubleDouble x) { return sine_cosine(x).sine; }
DoubleDouble cos(DoubleDouble x) { return sine_cosine(x).cosine; }

/// |a - b|
double apart(DoubleDouble a, DoubleDouble b) {
  return std::abs((a.high - b.high) + (a.low - b.low));
}

DoubleDouble draw(Stream& stream) {
  const double high = stream.uniform(-2, 2);
  return DoubleDouble::sum(high, 0x1p-54 * stream.uniform(-1, 1));
}

struct Row {
  DoubleDouble (*of)(DoubleDouble);
  DoubleDouble x, y;
};
/// By mpmath, with 300 bits.
const Row kRows[] = {
    {exp,
     {0x1.d7f1483a9d150p2, 0x1.c8703006a556dp-53},
     {0x1.8e8a2f67c2ae5p10, 0x1.8ed25b4dc9f57p-44}},
    {exp,
     {0x1.1b62c54ada86ep4, 0x1.f5895b6a015d7p-51},
     {0x1.7771e873c20d9p25, -0x1.ee6e0deead10ep-30}},
    {exp,
     {0x1.4fdba6311b050p8, 0x1.1baeb5c9e9f10p-46},
     {0x1.746450fefe4bfp484, 0x1.83fb369b0038cp429}},
    {exp,
     {-0x1.49b24359f833dp9, 0x1.6ab0d31ab41e2p-49},
     {0x1.9f2388bc653a8p-952, 0x1.bdca325961ec9p-1007}},
    {sin,
     {0x1.547f7a37e8b7cp1, 0x1.95cde351e7571p-55},
     {0x1.da2e36b9fc2d6p-2, -0x1.ba2b2ef13bc6bp-58}},
    {sin,
     {0x1.33e43e6f0ec74p1, -0x1.dc5ccd00c0a75p-54},
     {0x1.57cad0ed379dap-1, 0x1.1132faf485527p-55}},
    {sin,
     {-0x1.8bea8b527cbe0p4, 0x1.9157faecfcbc5p-51},
     {0x1.83660233a6c5bp-2, -0x1.020438a5107adp-56}},
    {sin,
     {0x1.1811cab1945b8p5, 0x1.4b56b7e44bbd1p-52},
     {-0x1.be7b46dd0a376p-2, -0x1.1bfcfd4645ae0p-58}},
    {cos,
     {-0x1.75eda539ce6dep1, 0x1.a7b0e4056d699p-54},
     {-0x1.f3a0e131a169fp-1, 0x1.06363adcc4067p-55}},
    {cos,
     {-0x1.52b70fdd0a9e2p0, -0x1.1a0b7fa8c1c5dp-54},
     {0x1.f619648cb9ecdp-3, -0x1.2c235fcee9411p-57}},
    {cos,
     {0x1.a929251de3308p7, -0x1.21722271f961ap-47},
     {0x1.ff579b164f9a4p-2, -0x1.d7bfcc81b6869p-57}},
    {cos,
     {0x1.db6f685e62e7cp7, -0x1.577c40846a1afp-47},
     {0x1.01a918acd73c3p-1, -0x1.26e5dcf0f1728p-55}},
    {sqrt,
     {0x1.34b9f8b9d7d3ep9, -0x1.ccfdc4dc8b28cp-46},
     {0x1.8d93dd319fc5dp4, -0x1.eb3fc62a20792p-53}},
    {sqrt,
     {0x1.c69ec9fb1d1c0p0, 0x1.51b23d7524fafp-54},
     {0x1.55263327bf183p0, -0x1.91610f3a1ed1dp-57}},
    {sqrt,
     {0x1.359eeef8c1479p0, -0x1.605f304a4e899p-55},
     {0x1.19896780d3277p0, 0x1.a39e4db61c35ep-54}},
    {sqrt,
     {0x1.fb7ff3254eb22p0, 0x1.79fe6578a9ec9p-54},
     {0x1.6871b096bbab0p0, -0x1.95afea704934ep-54}},
};

TEST(DoubleDouble, FunctionsAreWithinTheirErrors) {
  for (const Row& row : kRows) {
    const double scale = std::max(
        {std::abs(row.y.high), row.of == exp ? 0 : std::abs(row.x.high), 0.0});
    EXPECT_LE(apart(row.of(row.x), row.y), 0x1p-93 * scale)
        << row.x.high << " gives " << row.of(row.x).high;
  }
}

TEST(DoubleDouble, SumsAndProductsOfDoublesAreExact) {
  EXPECT_EQ(DoubleDouble::sum(1, 0x1p-80).low, 0x1p-80);
  EXPECT_EQ(DoubleDouble::sum(0x1p-80, 1).low, 0x1p-80);
  const double x = 1 + 0x1p-30;  // x^2 = 1 + 2^-29 + 2^-60
  EXPECT_EQ(DoubleDouble::product(x, x).high, 1 + 0x1p-29);
  EXPECT_EQ(DoubleDouble::product(x, x).low, 0x1p-60);
}

TEST(DoubleDouble, OperationsUndoEachOther) {
  Stream stream = Rng::root("double double", 0).stream();
  for (int i = 0; i < 2000; ++i) {
    const DoubleDouble a = draw(stream), b = draw(stream);
    const double scale = std::abs(a.high) + std::abs(b.high);
    EXPECT_LE(apart(a + b - b, a), 0x1p-103 * scale);
    EXPECT_LE(apart(a * b / b, a), 0x1p-101 * std::abs(a.high));
    EXPECT_LE(apart(sqrt(a * a), a < 0 ? -a : a), 0x1p-102 * scale);
    EXPECT_LE(apart(exp(a) * exp(-a), 1), 0x1p-95);
    const auto [s, c] = sine_cosine(a);
    EXPECT_LE(apart(s * s + c * c, 1), 0x1p-99);
  }
}

TEST(DoubleDouble, WhatIsNotFiniteStaysSo) {
  const DoubleDouble inf = kInfinity, nan = NAN;
  EXPECT_EQ(double(inf + 1), kInfinity);
  EXPECT_EQ(double(inf * 2), kInfinity);
  EXPECT_EQ(double(1 / DoubleDouble(0)), kInfinity);
  EXPECT_EQ(double(1 / inf), 0);
  EXPECT_EQ(double(exp(DoubleDouble(1000))), kInfinity);
  EXPECT_EQ(double(exp(-inf)), 0);
  EXPECT_EQ(double(exp(DoubleDouble(-745))), 0x1p-1074);
  EXPECT_TRUE(std::isnan(double(nan + 1)));
  EXPECT_TRUE(std::isnan(double(exp(nan))));
  EXPECT_TRUE(std::isnan(double(sine_cosine(inf).sine)));
  EXPECT_TRUE(std::isnan(double(sqrt(DoubleDouble(-1)))));
  EXPECT_EQ(double(sqrt(DoubleDouble(0))), 0);
}

/// Every processor and compiler makes this number.
TEST(DoubleDouble, HasTheSameBitsEverywhere) {
  Stream stream = Rng::root("double double", 1).stream();
  std::uint64_t hash = 0;
  const auto add = [&](DoubleDouble x) {
    for (const double part : {x.high, x.low})
      hash = hash * 0x100000001b3 + std::bit_cast<std::uint64_t>(part);
  };
  for (int i = 0; i < 2000; ++i) {
    const DoubleDouble a = draw(stream), b = draw(stream);
    add(a + b), add(a * b), add(a / b), add(sqrt(a * a)), add(exp(a));
    add(sin(100 * a)), add(cos(100 * b));
  }
  EXPECT_EQ(hash, 6608531226547166007U);
}

}  // namespace
}  // namespace physinv
