#include "suite/core/whole.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace physinv {
namespace {

template <class I>
class WholePart : public ::testing::Test {};

using Integers = ::testing::Types<std::int8_t,
                                  std::uint8_t,
                                  std::int32_t,
                                  std::uint32_t,
                                  std::int64_t,
                                  std::uint64_t>;
TYPED_TEST_SUITE(WholePart, Integers);

TYPED_TEST(WholePart, IsTheSameOnEveryProcessor) {
  using I = TypeParam;
  constexpr I kLeast = std::numeric_limits<I>::min();
  constexpr I kMost = std::numeric_limits<I>::max();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double v : {0.0, -0.0, 0.99, -0.99, kNan, -kNan})
    EXPECT_EQ(whole_part<I>(v), 0) << v;
  EXPECT_EQ(whole_part<I>(7.99), 7);
  EXPECT_EQ(whole_part<I>(-7.99), std::is_signed_v<I> ? I(-7) : I(0));
  for (const double v : {1e300, double{INFINITY}, std::ldexp(1.0, 64)})
    EXPECT_EQ(whole_part<I>(v), kMost) << v;
  for (const double v : {-1e300, -double{INFINITY}, -std::ldexp(1.0, 64)})
    EXPECT_EQ(whole_part<I>(v), kLeast) << v;
}

TYPED_TEST(WholePart, IsExactAtTheEnds) {
  using I = TypeParam;
  constexpr int kBits = std::numeric_limits<I>::digits;
  const double end = std::ldexp(1.0, kBits);
  EXPECT_EQ(whole_part<I>(end), std::numeric_limits<I>::max());
  const double below = std::nextafter(end, 0.0);
  EXPECT_EQ(whole_part<I>(below), static_cast<I>(below));
  EXPECT_EQ(whole_part<I>(static_cast<double>(std::numeric_limits<I>::min())),
            std::numeric_limits<I>::min());
}

}  // namespace
}  // namespace physinv
