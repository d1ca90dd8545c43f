#include "suite/core/math.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "suite/core/double_double.h"
#include "suite/core/math_lanes.h"
#include "suite/core/power_of_ten.h"
#include "suite/core/rng.h"

#ifdef EIGEN_VECTORIZE
#error Sums of Eigen follow the register: EIGEN_DONT_VECTORIZE is missing
#endif

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

TEST(Hypot, IsThatOfTheDefinition) {
  Stream stream = Rng::root("hypot", 0).stream();
  for (int i = 0; i < kTries; ++i) {
    const int size = static_cast<int>(stream.uniform(-980, 980));
    const double x = std::ldexp(stream.uniform(-1, 1), size),
                 y = std::ldexp(stream.uniform(-1, 1), size + i % 70 - 35);
    const DoubleDouble a = std::ldexp(x, -size), b = std::ldexp(y, -size);
    const double exact = std::ldexp(double(sqrt(a * a + b * b)), size);
    EXPECT_NEAR(math::hypot(x, y), exact, std::abs(exact) * 0x1p-52);
    EXPECT_EQ(math::hypot(y, -x), math::hypot(x, y));
  }
  EXPECT_EQ(math::hypot(3.0, 4.0), 5.0);
  EXPECT_EQ(math::hypot(3.F, 4.F), 5.F);
  EXPECT_EQ(math::hypot(-0.0, 0.0), 0.0);
  EXPECT_EQ(math::hypot(0x1p-1074, 0.0), 0x1p-1074);
  EXPECT_EQ(math::hypot(3 * 0x1p-1074, 4 * 0x1p-1074), 5 * 0x1p-1074);
  EXPECT_EQ(math::hypot(0x1.8p1022, 0x1p1023), 0x1.4p1023);
  EXPECT_EQ(math::hypot(double(INFINITY), double(NAN)), INFINITY);
  EXPECT_TRUE(std::isnan(math::hypot(1.0, double(NAN))));
  EXPECT_EQ(math::abs(std::complex<double>(3, -4)), 5.0);
}

/// Every processor and compiler makes this number.
TEST(Functions, HaveTheSameBitsEverywhere) {
  Stream stream = Rng::root("math", 1).stream();
  std::uint64_t hash = 0;
  const auto add = [&](auto x) {
    using Bits = LaneInt<decltype(x)>;
    hash = hash * 0x100000001b3 + std::uint64_t(std::bit_cast<Bits>(x));
  };
  const auto add_all = [&](auto x, auto y) {
    const auto positive = std::abs(x) + std::abs(y), share = x / 10;
    for (const auto value :
         {math::exp(x),          math::exp2(x),          math::expm1(x),
          math::log(positive),   math::log1p(positive),  math::log2(positive),
          math::log10(positive), math::sin(x),           math::cos(x),
          math::tan(x),          math::asin(share),      math::acos(share),
          math::tanh(x),         math::atanh(share),     math::erf(x),
          math::erfc(x),         math::lgamma(positive), math::pow(positive, y),
          math::sincos(x).sine,  math::sincos(y).cosine, math::hypot(x, y)})
      add(value);
  };
  for (int i = 0; i < 2000; ++i) {
    const double x = stream.uniform(-10, 10), y = stream.uniform(-10, 10);
    add_all(x, y), add_all(float(x), float(y)), add(math::atan2(x, y));
    const auto four = math::exp(Pack<double, 4>{x, y, -x, -y});
    const auto eight = math::log1p(Pack<float, 8>{} + float(x + 10));
    add(four[0]), add(four[3]), add(eight[5]);
  }
  EXPECT_EQ(hash, 13762146574131944207U);
}

TEST(PowerOfTen, IsTheNearestDoubleWhereWhole) {
  EXPECT_EQ(math::power_of_ten(-5.0), 1e-5);  // pow is one off
  EXPECT_EQ(math::power_of_ten(165.0), 1e165);
  EXPECT_EQ(math::power_of_ten(-323.0), 1e-323);
  EXPECT_EQ(math::power_of_ten(400.0), INFINITY);
  EXPECT_NEAR(math::power_of_ten(0.5), std::sqrt(10), 1e-15);
  EXPECT_TRUE(std::isnan(math::power_of_ten(double(NAN))));
}

}  // namespace
}  // namespace physinv
