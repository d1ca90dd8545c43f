#include "optimizers/steps/clip_percentile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/jpo_entries.h"

namespace physinv {
namespace {

TEST(ClipPercentileReference, Entry) {
  test::check_entries_named(
      "jpo-billiards", "clip_percentile_*", test::check_clip);
}

template <class T>
class ClipPercentileTest : public testing::Test {
 public:
  static constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
  static constexpr T kInf = std::numeric_limits<T>::infinity();
  static double clip(Batch<T>& g, double q = 0.9) {
    return ClipPercentile(q).template operator()<T>(g);
  }
};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(ClipPercentileTest, Scalars);

TYPED_TEST(ClipPercentileTest, OrderStatisticWithoutInterpolation) {
  Batch<TypeParam> g(1, 11);  // position 9 of 0..10
  for (Index i = 0; i < 11; ++i) g(0, i) = static_cast<TypeParam>(11 - i);
  EXPECT_EQ(this->clip(g), 10);
  EXPECT_EQ(g(0, 0), 10);
  EXPECT_EQ(g(0, 1), 10);
  EXPECT_EQ(g(0, 10), 1);
}

TYPED_TEST(ClipPercentileTest, NonFiniteColumnsVanishWithoutAVote) {
  Batch<TypeParam> g(2, 4);
  g << 3, this->kNan, 6, 1, 4, 1, 8, this->kInf;
  EXPECT_NEAR(this->clip(g), 9.5, 1e-6);
  EXPECT_EQ(g(0, 0), 3);
  EXPECT_TRUE(g.col(1).isZero(0));
  EXPECT_TRUE(g.col(3).isZero(0));
  EXPECT_NEAR(g(1, 2), 7.6, 1e-6);
}

TYPED_TEST(ClipPercentileTest, NobodyFinite) {
  Batch<TypeParam> g = Batch<TypeParam>::Constant(2, 3, this->kNan);
  EXPECT_EQ(this->clip(g), 0);
  EXPECT_TRUE(g.isZero(0));
  Batch<TypeParam> none(2, 0);
  EXPECT_EQ(this->clip(none), 0);
}

TYPED_TEST(ClipPercentileTest, ZerosStayAndAZeroThresholdClearsAll) {
  Batch<TypeParam> g = Batch<TypeParam>::Zero(2, 3);
  g(0, 1) = 5;
  EXPECT_NEAR(this->clip(g), 4, 1e-6);  // 0 0 5 at position 1.8
  EXPECT_NEAR(g(0, 1), 4, 1e-6);
  EXPECT_TRUE(g.col(0).isZero(0));

  Batch<TypeParam> sparse = Batch<TypeParam>::Zero(2, 31);
  sparse(1, 30) = 7;
  EXPECT_EQ(this->clip(sparse), 0);
  EXPECT_TRUE(sparse.isZero(0));
}

TYPED_TEST(ClipPercentileTest, ExtremesNeitherOverflowNorVanish) {
  const TypeParam big = std::numeric_limits<TypeParam>::max() / 4;
  const TypeParam small = std::numeric_limits<TypeParam>::min();
  Batch<TypeParam> g(2, 2);
  g << big, small, big, small;
  const double tau = this->clip(g, 0.0);
  EXPECT_NEAR(tau / (std::sqrt(2.0) * static_cast<double>(small)), 1, 1e-12);
  EXPECT_NEAR(g(0, 0) / small, 1, 1e-5);
  EXPECT_EQ(g(0, 1), small);
}

TYPED_TEST(ClipPercentileTest, SingleColumnIsItsOwnThreshold) {
  Batch<TypeParam> g(2, 1);
  g << 3, 4;
  EXPECT_EQ(this->clip(g), 5);
  EXPECT_EQ(g(1, 0), 4);
}

}  // namespace
}  // namespace physinv
