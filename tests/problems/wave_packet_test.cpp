#include "problems/wave_packet/wave_packet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "suite/core/any_problem.h"
#include "suite/core/check.h"
#include "tests/support/bits.h"
#include "tests/support/gradient_check.h"
#include "tests/support/physics.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Index kSamples = 256;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

template <class T>
Batch<T> quiet(Index n) {
  return Batch<T>::Zero(kSamples, n);
}

template <class T>
Batch<T> signals(const Batch<T>& x, const Batch<T>& given) {
  return Physics{AnyProblem<T>(problems::wave_packet())}.forward(x, given);
}

template <class T>
Batch<T> signals(const Batch<T>& x) {
  return signals(x, quiet<T>(x.cols()));
}

template <class T>
Batch<T> jacobians(const Batch<T>& x) {
  return Physics{AnyProblem<T>(problems::wave_packet())}.jacobian(
      x, quiet<T>(x.cols()));
}

template <class T>
Batch<T> pulled(const Batch<T>& x, const Batch<T>& given, const Batch<T>& r) {
  return Physics{AnyProblem<T>(problems::wave_packet())}.gradient(x, given, r);
}

template <class T>
Vector<double> losses(const Batch<T>& y, const Batch<T>& target) {
  Vector<double> loss(y.cols());
  AnyProblem<T>(problems::wave_packet()).loss(y, target, loss);
  return loss;
}

/// u and du/dxi as in the formulas.
double formula(double t, double xi, const WavePacketOptions& o = {}) {
  const double d = t - (o.centre + o.scale * xi);
  return o.amplitude * std::cos(o.frequency * d + o.phase) *
         std::exp(-d * d / (2 * o.width * o.width));
}
double slope(double t, double xi) {
  const double d = t - (128 + 128 * xi);
  return 128 * (std::sin(d) + std::cos(d) * d / 400) * std::exp(-d * d / 800);
}

Samples<double> draw(Index n, std::uint64_t seed = 1) {
  return AnyProblem<double>(problems::wave_packet())
      .sample_labelled(0, n, Rng::root("test/wave_packet", seed));
}

/// Centres inside the window, around it, and where packets end.
Batch<double> places() {
  Batch<double> x(1, 401);
  x.row(0).setLinSpaced(-2.7, 2.7);
  return x;
}

template <class T>
class WavePacketIn : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(WavePacketIn, Scalars);

TYPED_TEST(WavePacketIn, SignalsAndSlopesFollowTheirFormulas) {
  using T = TypeParam;
  const bool single = sizeof(T) == 4;
  const Batch<T> x = places().template cast<T>();
  const Batch<T> y = signals(x), j = jacobians(x);
  double worst = 0, worst_slope = 0;
  for (Index i = 0; i < x.cols(); ++i) {
    for (Index k = 0; k < kSamples; ++k) {
      const auto t = static_cast<double>(k + 1);
      const auto xi = static_cast<double>(x(0, i));
      worst = std::max(worst, std::abs(double(y(k, i)) - formula(t, xi)));
      worst_slope =
          std::max(worst_slope, std::abs(double(j(k, i)) - slope(t, xi)));
    }
  }
  EXPECT_LT(worst, single ? 1e-6 : 1e-13);
  EXPECT_LT(worst_slope, 128 * (single ? 1e-6 : 1e-13));
}

TEST(WavePacket, OtherConstants) {
  const WavePacketOptions o{.samples = 64,
                            .amplitude = -2.5,
                            .frequency = 2.75,
                            .phase = 0.4,
                            .width = 1.5,
                            .centre = 30,
                            .scale = 10};
  const AnyProblem<double> packet(problems::wave_packet(o));
  Batch<double> x(1, 101), y(64, 101);
  x.row(0).setLinSpaced(-4, 5);
  Workspace work;
  packet.forward(x, Batch<double>::Zero(64, 101), y, work);
  for (Index i = 0; i < 101; ++i)
    for (Index k = 0; k < 64; ++k)
      ASSERT_NEAR(y(k, i), formula(double(k + 1), x(0, i), o), 1e-13);
}

TEST(WavePacket, WholeSquaredErrorIsTwiceTheHalf) {
  const AnyProblem<double> half(problems::wave_packet()),
      whole(problems::wave_packet({.half_loss = false}));
  const Batch<double> y = draw(3, 1).y, target = draw(3, 2).y;
  Vector<double> a(3), b(3);
  Batch<double> slope(y), twice(y);
  half.loss(y, target, a), whole.loss(y, target, b);
  half.loss_gradient(y, target, slope);
  whole.loss_gradient(y, target, twice);
  EXPECT_EQ(b, 2 * a);
  EXPECT_EQ(twice, 2 * slope);
}

TEST(WavePacket, JacobianAgreesWithCentralDifferences) {
  const Batch<double> x = draw(40).x, j = jacobians(x);
  for (Index i = 0; i < 40; ++i) {
    const auto d = difference_jacobian(
        [](const Vector<double>& at) {
          return Vector<double>(signals<double>(at).col(0));
        },
        x.col(i));
    EXPECT_TRUE(Comparator(1e-6, 0)(j.col(i), d));
  }
}

TYPED_TEST(WavePacketIn, PullbackIsTheTransposedJacobian) {
  using T = TypeParam;
  const Batch<T> x = places().template cast<T>();
  const Batch<T> r = draw(x.cols(), 2).y.template cast<T>();
  const Batch<T> x_bar = pulled(x, quiet<T>(x.cols()), r), j = jacobians(x);
  EXPECT_TRUE(Comparator(Tolerance<T>::relative, 0)(
      x_bar.row(0), j.cwiseProduct(r).colwise().sum()));
}

TYPED_TEST(WavePacketIn, BitsDependNeitherOnPositionNorOnBatch) {
  using T = TypeParam;
  const Batch<T> x = places().template cast<T>();
  const auto s = draw(x.cols(), 2).template cast<T>();
  const Batch<T> y = signals(x, s.given), x_bar = pulled(x, s.given, s.y);
  for (const Index size : {1, 7, 64}) {
    for (Index first = 0; first + size <= x.cols(); first += size) {
      const auto part = [&](const Batch<T>& all) {
        return Batch<T>(all.middleCols(first, size).rowwise().reverse());
      };
      EXPECT_TRUE(same_bits(signals(part(x), part(s.given)), part(y)));
      EXPECT_TRUE(
          same_bits(pulled(part(x), part(s.given), part(s.y)), part(x_bar)));
    }
  }
}

TYPED_TEST(WavePacketIn, TheDisturbanceIsAdded) {
  using T = TypeParam;
  const Batch<T> x = places().template cast<T>();
  const Batch<T> given = draw(x.cols()).given.template cast<T>();
  EXPECT_TRUE(Comparator(Tolerance<T>::relative, 0)(signals(x, given),
                                                    signals(x) + given));
}

TYPED_TEST(WavePacketIn, EmptyBatchesAndMemory) {
  using T = TypeParam;
  const AnyProblem<T> packet(problems::wave_packet());
  Tape tape;
  Workspace work;
  for (const Index n : {64, 0, 3, 64}) {
    const auto s = draw(n).template cast<T>();
    Batch<T> y(kSamples, n), x_bar(1, n);
    packet.linearize(s.x, s.given, y, tape);
    packet.pullback(tape, y, x_bar, work);
    EXPECT_LE(tape.bytes(),
              64 * (kSamples * sizeof(T) + 2 * sizeof(Index)) + 2 * kAlignment);
  }
  EXPECT_EQ(work.bytes(), 0U);
}

// ---- out of the window ------------------------------------------------------

TYPED_TEST(WavePacketIn, FarAwayThereIsExactlyNothing) {
  using T = TypeParam;
  Batch<T> x(1, 5);
  x << T(9), T(-9), T(1e9), T(-3e38), std::numeric_limits<T>::max();
  const Batch<T> y = signals(x), j = jacobians(x);
  EXPECT_TRUE((y.array() == 0).all());
  EXPECT_TRUE((j.array() == 0).all());
  const Batch<T> r = draw(5).y.template cast<T>();
  EXPECT_TRUE((pulled(x, quiet<T>(5), r).array() == 0).all());
  // The disturbance stays.
  EXPECT_TRUE(same_bits(signals(x, r), r));
}

/// Whatever pushed the packet out, the loss is the same, to the last bit.
TYPED_TEST(WavePacketIn, LossesWithoutPacketAreEqual) {
  using T = TypeParam;
  Batch<T> x(1, 6);
  x << T(9), T(5.05), T(-5.05), T(3), T(-4), T(1e9);
  const Batch<T> target = draw(1).y.template cast<T>().replicate(1, 6);
  const Vector<double> loss = losses<T>(signals(x), target);
  EXPECT_TRUE((loss.array() == loss(0)).all());
  EXPECT_NEAR(loss(0),
              0.5 * target.col(0).template cast<double>().squaredNorm(),
              1e-14 * loss(0));
}

/// Gradient descent looks at their sign.
TEST(WavePacket, SlopesKeepTheirSignUntilExpUnderflows) {
  for (const double xi : {-6.7, -5.05, 3.3, 5.05, 6.7}) {
    const Batch<double> j =
        jacobians<double>(Batch<double>::Constant(1, 1, xi));
    Index seen = 0;
    for (Index k = 0; k < kSamples; ++k) {
      const double expected = slope(double(k + 1), xi);
      if (std::abs(expected) < 1e-300) continue;
      ++seen;
      EXPECT_NEAR(j(k, 0) / expected, 1, 1e-9) << xi << " at " << k;
    }
    EXPECT_GT(seen, 0);
  }
}

TYPED_TEST(WavePacketIn, CountsWhatItDoesNotCompute) {
  using T = TypeParam;
  const auto skipped = [](double xi) {
    const Batch<T> x = Batch<T>::Constant(1, 1, T(xi));
    Batch<T> y(kSamples, 1);
    Workspace work;
    Tape tape;
    AnyProblem<T>(problems::wave_packet()).forward(x, quiet<T>(1), y, work);
    AnyProblem<T>(problems::wave_packet()).linearize(x, quiet<T>(1), y, tape);
    EXPECT_EQ(work.counts, tape.counts);
    return work.counts[Counter::skipped_zeros];
  };
  const bool single = sizeof(T) == 4;
  EXPECT_EQ(skipped(0), 0U);
  EXPECT_EQ(skipped(-1), single ? 64U : 0U);      // float sees it up to t = 177
  EXPECT_EQ(skipped(-5.5), single ? 256U : 32U);  // double up to t = 197
  EXPECT_EQ(skipped(9), 256U);
  EXPECT_EQ(skipped(kNan), 0U);
}

TYPED_TEST(WavePacketIn, TheLossIsContinuousWherePacketsEnd) {
  using T = TypeParam;
  const Batch<double> target = draw(1).y;
  for (const double edge : {-772.5, -177.0, -176.0, 433.0, 434.0, 1029.5}) {
    Batch<T> x(1, 2);
    x << T((edge - 1 - 128) / 128), T((edge + 1 - 128) / 128);
    const Vector<double> l =
        losses<T>(signals(x), target.template cast<T>().replicate(1, 2));
    EXPECT_NEAR(l(0), l(1), 1e-14 * l(0));
  }
}

TYPED_TEST(WavePacketIn, WhatIsNotFiniteStaysInItsColumn) {
  using T = TypeParam;
  const auto s = draw(5).template cast<T>();
  Batch<T> x = s.x;
  x(0, 1) = T(kNan), x(0, 3) = -T(kInf);
  const Batch<T> y = signals(x, s.given), x_bar = pulled(x, s.given, s.y);
  for (const Index i : {1, 3}) {
    EXPECT_TRUE(y.col(i).array().isNaN().all());
    EXPECT_TRUE(std::isnan(x_bar(0, i)));
    EXPECT_TRUE(std::isnan(losses(y, s.y)(i)));
  }
  for (const Index i : {0, 2, 4}) {
    EXPECT_TRUE(y.col(i).allFinite());
    EXPECT_TRUE(std::isfinite(x_bar(0, i)));
  }
}

// ---- losses and data --------------------------------------------------------

TYPED_TEST(WavePacketIn, LossIsHalfTheSquaredErrorInDouble) {
  using T = TypeParam;
  const auto a = draw(30).template cast<T>(),
             b = draw(30, 2).template cast<T>();
  const Vector<double> loss = losses(a.y, b.y);
  for (Index i = 0; i < 30; ++i) {
    double sum = 0;
    for (Index k = 0; k < kSamples; ++k) {
      const auto r = static_cast<double>(a.y(k, i) - b.y(k, i));
      sum += r * r;
    }
    EXPECT_NEAR(loss(i), 0.5 * sum, 1e-14 * sum);
  }
}

TEST(WavePacket, TestSetsHideTheNoiseOfTheSameSignals) {
  const AnyProblem<double> packet(problems::wave_packet());
  const Rng rng = Rng::root("test/wave_packet", 3);
  const auto shown = packet.sample_labelled(0, 50, rng);
  const auto hidden = packet.sample(0, 50, rng);
  EXPECT_TRUE(same_bits(shown.x, hidden.x));
  EXPECT_TRUE(same_bits(shown.y, hidden.y));
  EXPECT_TRUE((hidden.given.array() == 0).all());
  EXPECT_TRUE(same_bits(signals(shown.x, shown.given), shown.y));
  EXPECT_TRUE(Comparator(1e-14, 0)(shown.y - signals(shown.x), shown.given));
}

TEST(WavePacket, SamplesHaveTheirDistribution) {
  constexpr Index n = 4000;
  const auto s = draw(n);
  const Vector<double> t0 = (128 + 128 * s.x.row(0).array()).transpose();
  EXPECT_GE(t0.minCoeff(), 26);
  EXPECT_LT(t0.maxCoeff(), 230);
  EXPECT_NEAR(t0.mean(), 128, 4 * 204 / std::sqrt(12.0 * n));
  EXPECT_NEAR((t0.array() - 128).square().mean(), 204 * 204 / 12.0, 120);
  EXPECT_NEAR(s.given.mean(), 0, 4 * 0.1 / std::sqrt(256.0 * n));
  EXPECT_NEAR(s.given.squaredNorm() / (256.0 * n), 0.01, 1e-4);
  // Neighbouring samples, and neighbouring signals, share nothing.
  EXPECT_NEAR(s.given.row(0).dot(s.given.row(1)) / n, 0, 4 * 0.01 / 63);
  EXPECT_NEAR(s.given.col(0).dot(s.given.col(1)) / 256, 0, 4 * 0.01 / 16);
}

TEST(WavePacket, ChecksItsContract) {
  const AnyProblem<double> packet(problems::wave_packet());
  Batch<double> x(2, 2), given(256, 2), y(256, 2);
  Workspace work;
  EXPECT_THROW(packet.forward(x, given, y, work), ContractError);
  EXPECT_THROW(packet.forward(x.topRows(1), given.topRows(9), y, work),
               ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::wave_packet({.samples = 100})),
               ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::wave_packet({.width = 0.5})),
               ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::wave_packet({.noise = -1})),
               ContractError);
}

}  // namespace
}  // namespace physinv::test
