#include "suite/core/nan.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "suite/core/simd/finite.h"

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

template <class T>
void finds_each_of() {
  constexpr T kMost = std::numeric_limits<T>::max();
  for (Index n = 0; n <= 40; ++n) {
    std::vector<T> v(static_cast<std::size_t>(n), kMost);
    EXPECT_TRUE(all_finite(v.data(), n));
    for (auto& x : v) {
      for (const T bad : {std::numeric_limits<T>::quiet_NaN(),
                          -std::numeric_limits<T>::quiet_NaN(),
                          std::numeric_limits<T>::infinity(),
                          -std::numeric_limits<T>::infinity()}) {
        x = bad;
        EXPECT_FALSE(all_finite(v.data(), n)) << n << " at " << &x - v.data();
      }
      x = -kMost;
    }
    EXPECT_TRUE(all_finite(v.data(), n));
  }
}

TEST(Finite, FindsWhatIsNotAtAnyPlace) {
  finds_each_of<double>();
  finds_each_of<float>();
}

}  // namespace
}  // namespace physinv
