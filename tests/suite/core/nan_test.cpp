#include "suite/core/nan.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <vector>

namespace physinv {
namespace {

TEST(Nan, HasOneBitPattern) {
  constexpr std::uint64_t kMade = 0x7ff8000000000000, kSign = 1UL << 63;
  std::vector<double> v = {1, -0.0, -INFINITY};
  for (const std::uint64_t bits :
       {kMade, kMade | kSign, kMade | 5, kSign | 0x7ff0000000000001})
    v.push_back(std::bit_cast<double>(bits));
  EXPECT_TRUE(has_nan(v.data(), static_cast<Index>(v.size())));
  EXPECT_FALSE(has_nan(v.data(), 3));
  unify_nan(v);
  for (std::size_t i = 3; i < v.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(v[i]), kMade) << i;
  EXPECT_EQ(v[0], 1);
  EXPECT_TRUE(v[1] == 0 && std::signbit(v[1]));
  EXPECT_EQ(v[2], -INFINITY);
}

TEST(Nan, AlsoInFloatAndInMatrices) {
  Batch<float> m(3, 4);
  m.setZero();
  m(2, 3) = std::bit_cast<float>(0xffc00007U);
  unify_nan(m);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(m(2, 3)), 0x7fc00000U);
  EXPECT_FALSE(has_nan(m.data(), 11));
  Batch<double> none;
  unify_nan(none);
}

}  // namespace
}  // namespace physinv
