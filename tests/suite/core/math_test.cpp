#include "suite/core/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "suite/core/rng.h"
#include "suite/core/simd/pack.h"

namespace physinv {
namespace {

constexpr int kTries = 20000;

/// |value - exact| in units of the last place of T at `exact`.
template <class T>
double ulps(T value, long double exact) {
  const T near = static_cast<T>(exact);
  const T unit = std::nextafter(std::abs(near), T(INFINITY)) - std::abs(near);
  return static_cast<double>(std::abs(value - exact) / unit);
}

template <class T>
class Math : public testing::Test {};
using Numbers = testing::Types<float, double>;
TYPED_TEST_SUITE(Math, Numbers);

TYPED_TEST(Math, IsWithinAnUlpOfLongDouble) {
  using T = TypeParam;
  using L = long double;
  Stream stream = Rng::root("math", 0).stream();
  double worst = 0, worst_erfc = 0;
  for (int i = 0; i < kTries; ++i) {
    const T x = static_cast<T>(20 * stream.uniform() - 10);
    const T positive = static_cast<T>(std::ldexp(1 + stream.uniform(), i % 60));
    const T share = x / 10;
    for (const double error : {
             ulps<T>(math::exp(x), std::exp(L(x))),
             ulps<T>(math::expm1(x), std::expm1(L(x))),
             ulps<T>(math::log(positive), std::log(L(positive))),
             ulps<T>(math::log2(positive), std::log2(L(positive))),
             ulps<T>(math::log10(positive), std::log10(L(positive))),
             ulps<T>(math::log1p(positive), std::log1p(L(positive))),
             ulps<T>(math::sin(x), std::sin(L(x))),
             ulps<T>(math::cos(x), std::cos(L(x))),
             ulps<T>(math::sincos(x).sine, std::sin(L(x))),
             ulps<T>(math::sincos(x).cosine, std::cos(L(x))),
             ulps<T>(math::tan(x), std::tan(L(x))),
             ulps<T>(math::asin(share), std::asin(L(share))),
             ulps<T>(math::tanh(x), std::tanh(L(x))),
             ulps<T>(math::erf(x), std::erf(L(x))),
             ulps<T>(math::pow(positive, share),
                     std::pow(L(positive), L(share))),
         })
      worst = std::max(worst, error);
    worst_erfc = std::max(worst_erfc, ulps<T>(math::erfc(x), std::erfc(L(x))));
  }
  EXPECT_LE(worst, 1);
  EXPECT_LE(worst_erfc, 1.5);
}

template <class T, int W>
void expect_bits_of_each_alone(Stream& stream) {
  alignas(64) T x[W], exps[W], logs[W], sines[W], cosines[W];
  for (T& value : x) value = static_cast<T>(stream.uniform() - 0.5);
  for (int k = 0; k < W; ++k) x[k] = std::ldexp(x[k], 5 * k % 40);
  Pack<T, W> pack;
  std::memcpy(&pack, x, sizeof(x));
  const auto exp = math::exp(pack);
  const auto log = math::log1p(abs_lanes(pack));
  const auto [sine, cosine] = math::sincos(pack);
  std::memcpy(exps, &exp, sizeof(exps));
  std::memcpy(logs, &log, sizeof(logs));
  std::memcpy(sines, &sine, sizeof(sines));
  std::memcpy(cosines, &cosine, sizeof(cosines));
  for (int k = 0; k < W; ++k) {
    EXPECT_EQ(exps[k], math::exp(x[k])) << x[k];
    EXPECT_EQ(logs[k], math::log1p(std::abs(x[k]))) << x[k];
    EXPECT_EQ(sines[k], math::sincos(x[k]).sine) << x[k];
    EXPECT_EQ(cosines[k], math::sincos(x[k]).cosine) << x[k];
  }
}

TYPED_TEST(Math, SeveralAtOnceHaveTheBitsOfEachAlone) {
  using T = TypeParam;
  Stream stream = Rng::root("math", 1).stream();
  for (int i = 0; i < kTries; ++i) {
    expect_bits_of_each_alone<T, 32 / sizeof(T)>(stream);
    expect_bits_of_each_alone<T, kLanes<T>>(stream);
  }
}

TYPED_TEST(Math, EndsAreThoseOfTheStandard) {
  using T = TypeParam;
  constexpr T kInf = std::numeric_limits<T>::infinity();
  const T nan = std::numeric_limits<T>::quiet_NaN();
  EXPECT_EQ(math::exp(kInf), kInf);
  EXPECT_EQ(math::exp(-kInf), 0);
  EXPECT_EQ(math::log(T(0)), -kInf);
  EXPECT_EQ(math::pow(T(0), T(-1)), kInf);
  EXPECT_EQ(math::pow(T(2), T(10)), 1024);
  EXPECT_EQ(math::tanh(kInf), 1);
  for (const T value : {math::log(T(-1)),
                        math::sin(kInf),
                        math::cos(nan),
                        math::exp(nan),
                        math::asin(T(2)),
                        math::tanh(nan)})
    EXPECT_TRUE(std::isnan(value));
}

}  // namespace
}  // namespace physinv
