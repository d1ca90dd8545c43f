#include "problems/heat/heat.h"

#include "problems/heat/inversion.h"
#include "problems/heat/likelihood.h"
#include "suite/core/any_problem.h"
#include "suite/core/threads.h"
#include "tests/support/bits.h"
#include "tests/support/gradient_check.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

const Rng kHeatRng = Rng::root("heat_test", 1);

template <class T>
Batch<T> inverted(const AnyProblem<T>& heat,
                  const Batch<T>& y,
                  const Batch<T>& guess,
                  Threads* threads = nullptr) {
  Workspace work(threads);
  Batch<T> x(y);
  heat.invert(y, Batch<T>(0, y.cols()), guess, x, work);
  return x;
}

/// The step for dy itself: from zero.
Batch<double> step(const Batch<double>& dy, double end_time = 8) {
  const AnyProblem<double> heat(
      problems::heat({.resolution = 16, .end_time = end_time}));
  return inverted<double>(heat, dy, Batch<double>::Zero(256, dy.cols()));
}

TEST(Heat, IsItsOwnAdjointAndAProductOfCirculants) {
  const AnyProblem<double> heat(problems::heat({.resolution = 16}));
  Workspace work;
  const Batch<double> unit = Batch<double>::Identity(256, 256), given(0, 256);
  Batch<double> matrix(256, 256);
  heat.forward(unit, given, matrix, work);
  EXPECT_TRUE(Comparator(1e-15, 0)(matrix, matrix.transpose().eval()));
  Vector<double> along(16);  // c, from the definition
  for (Index d = 0; d < 16; ++d) {
    along(d) = 0;
    for (Index k = 0; k < 16; ++k) {
      const double f = (k < 8 ? double(k) : double(k) - 16) / 16;
      along(d) += std::exp(-std::pow(2 * M_PI * f, 2) * 8) *
                  std::cos(2 * M_PI * double(k * d % 16) / 16) / 16;
    }
  }
  for (Index a = 0; a < 256; ++a)
    for (Index b = 0; b < 256; ++b) {
      const auto apart = [](Index i, Index j) { return (i - j + 16) % 16; };
      EXPECT_NEAR(matrix(a, b),
                  along(apart(a / 16, b / 16)) * along(apart(a % 16, b % 16)),
                  1e-16);
    }
}

template <class T>
void check_one_field_by_itself() {
  const AnyProblem<T> heat(problems::heat());
  const auto s = heat.sample(0, 19, kHeatRng).template cast<T>();
  const Batch<T> zero = Batch<T>::Zero(s.x.rows(), 19);
  const Batch<T> all = inverted(heat, s.y, zero);
  Threads threads(3);
  EXPECT_TRUE(same_bits(inverted(heat, s.y, zero, &threads), all));
  Workspace work, threaded(&threads);
  Tape tape(&threads);
  Batch<T> y(s.y), one(s.x.rows(), 1), x_bar(s.x);
  heat.forward(s.x, s.given, y, work);
  heat.linearize(s.x, s.given, x_bar, tape);
  EXPECT_TRUE(same_bits(x_bar, y));
  heat.pullback(tape, s.x, x_bar, threaded);
  EXPECT_TRUE(same_bits(x_bar, y));
  for (const Index i : {0, 7, 8, 18}) {
    const Batch<T> yi = s.y.col(i), xi = s.x.col(i);
    EXPECT_TRUE(
        same_bits(inverted<T>(heat, yi, zero.col(i)), Batch<T>(all.col(i))));
    heat.forward(xi, s.given.leftCols(1), one, work);
    EXPECT_TRUE(same_bits(one, Batch<T>(y.col(i))));
  }
  // What is not finite stays in its column.
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(),
                      std::numeric_limits<T>::infinity()}) {
    Batch<T> broken = s.x, seen(s.y);
    broken(77, 4) = bad;
    const auto rest_is = [&](Batch<T> got, const Batch<T>& want) {
      EXPECT_FALSE(got.col(4).allFinite());
      got.col(4) = want.col(4);
      EXPECT_TRUE(same_bits(got, want));
    };
    heat.forward(broken, s.given, seen, work);
    rest_is(seen, y);
    heat.linearize(broken, s.given, seen, tape);
    heat.pullback(tape, s.x, x_bar, work);
    rest_is(x_bar, y);
    Batch<T> y_broken = s.y;
    y_broken(5, 4) = bad;
    rest_is(inverted(heat, y_broken, zero), all);
  }
}

TEST(Heat, AFieldDoesNotDependOnItsBatch) {
  check_one_field_by_itself<double>();
  check_one_field_by_itself<float>();
}

TEST(Heat, StepsOfWhatHasNoSignal) {
  EXPECT_TRUE(same_bits(step(Batch<double>::Zero(256, 1)),
                        Batch<double>::Zero(256, 1).eval()));
  const Batch<double> level = Batch<double>::Constant(256, 1, 0.25);
  EXPECT_TRUE(Comparator(1e-14, 0)(step(level), level));
  const Batch<double> tiny = Batch<double>::Constant(256, 1, 1e-100);
  EXPECT_TRUE(Comparator(1e-14, 0)(step(tiny), tiny));
  // One mode of size 1e6, far beyond what it could show: it is damped.
  Batch<double> wave(256, 1);
  for (Index i = 0; i < 256; ++i)
    wave(i) = 1e6 * std::cos(2 * M_PI * double(3 * (i % 16)) / 16);
  const double s = 9 * std::pow(2 * M_PI / 16, 2) * 8;
  EXPECT_TRUE(Comparator(1e-9, 0)(step(wave), (wave * std::exp(-s)).eval()));
}

// In logarithms the quotient would go to 1, and the mode would be amplified.
TEST(Heat, BothLikelihoodsVanishIntoDamping) {
  const auto far = HeatMode::of(40, 3, 1, 0.5);
  EXPECT_EQ(far.probability, 0);
  EXPECT_EQ(far.gain, std::exp(-3.0));
  const auto both_zero = HeatMode::of(40, 3, 1, 1e-9);
  EXPECT_EQ(both_zero.probability, 0);
  const auto near = HeatMode::of(30, 3, 1, 0.5);
  EXPECT_EQ(near.probability, 1);
  EXPECT_DOUBLE_EQ(near.gain, std::exp(3.0));
  const auto nothing = HeatMode::of(0, 3, 1, 0);  // 0 / 0
  EXPECT_EQ(nothing.gain, 1);
  const auto lost = HeatMode::of(1e-3, 1e4, 0, 1);  // e^-s underflowed
  EXPECT_EQ(lost.probability, 0);
  EXPECT_EQ(lost.gain, 0);
}

TEST(Heat, BetweenTheThresholdsNothingIsAmplified) {
  const auto gain_at = [](double p) {
    // S / (S + N) = p where the uncertainty is infinite and N = 1/2.
    const double z = std::sqrt(-2 * std::log(p / (1 - p)));
    return HeatMode::of(z, 1, 1, std::numeric_limits<double>::infinity()).gain;
  };
  EXPECT_NEAR(gain_at(0.4), std::exp(-0.2), 1e-12);
  // p up to 1 needs N below S.
  const auto with_noise = [](double p) {
    const double z = std::sqrt(2 * std::log(p / (1 - p)));
    return HeatMode::of(z, 1, std::numeric_limits<double>::infinity(), 1).gain;
  };
  EXPECT_EQ(with_noise(0.55), 1);
  EXPECT_EQ(with_noise(0.679), 1);
  EXPECT_NEAR(with_noise(0.681), std::exp(0.362), 1e-12);
}

/// Every mode by its own likelihoods, none taken for granted.
TEST(Heat, ModesWithoutSignalAreSkippedToTheSameBits) {
  const AnyProblem<double> heat(problems::heat());
  const auto s = heat.sample(0, 3, kHeatRng);
  Workspace work;
  Batch<double> x(s.x);
  heat.invert(s.y, s.given, Batch<double>::Zero(4096, 3), x, work);
  const auto skipped = work.counts[Counter::skipped_zeros];
  const std::uint64_t modes = std::uint64_t{3} * 2 * 33 * 33;
  EXPECT_GT(skipped, modes / 2);
  EXPECT_LT(skipped, modes);

  const HeatModes of({});
  const PlaneFft& fft = of.fft();
  using Lane = Pack<double, 2>;
  std::vector<Lane> u(4096), z(std::size_t(fft.spectrum())),
      scratch(std::size_t(fft.scratch()));
  std::uint64_t known = 0;
  for (Index i = 0; i < 3; ++i) {
    double sum = 0;
    for (Index r = 0; r < 4096; ++r) {
      u[std::size_t(r)] = Lane{} + s.y(r, i);
      const double e = 1e-6 * std::abs(s.y(r, i));
      sum = std::fma(e, e, sum);
    }
    fft.forward(u.data(), z.data(), scratch.data());
    fft.scale_modes(z.data(), [&](Index p, Index q, Lane re, Lane im) {
      const double e = of.exponents()(fft.mode(p), fft.mode(q));
      const double amplitude = std::sqrt(std::fma(re[0], re[0], im[0] * im[0]));
      const auto mode =
          HeatMode::of(amplitude, e, 64 * std::exp(-e), std::sqrt(sum));
      const double expected = 64 * std::exp(-e), noise = std::sqrt(sum);
      known += amplitude >= 39 * expected ||
               (amplitude > 39 * noise && amplitude < 37 * expected) ||
               amplitude < 0x1p-28 * std::min(noise, expected);
      return Lane{} + mode.gain;
    });
    fft.inverse(z.data(), u.data(), scratch.data());
    for (Index r = 0; r < 4096; ++r)
      ASSERT_EQ(x(r, i), u[std::size_t(r)][0] / 4096) << r;
  }
  EXPECT_EQ(known, skipped);
}

// Without a floor, the second step amplifies what rounding has left.
TEST(Heat, InversionOnSpectraIsThatOfCells) {
  for (const double floor : {0.0, 1e-8, 1e-3}) {
    const AnyProblem<double> heat(problems::heat({.noise_floor = floor}));
    const auto s = heat.sample(0, 11, kHeatRng);
    Workspace work, of_cells;
    const HeatModes modes({.noise_floor = floor});
    HeatInversion inversion(modes, s.y, work);
    Batch<double> x = Batch<double>::Zero(4096, 11), seen = x;
    for (int k = 0; k < (floor > 0 ? 12 : 1); ++k) {
      heat.invert(s.y, s.given, x, x, of_cells);
      inversion.step(work);
      inversion.estimate(seen, work);
      for (Index i = 0; i < 11; ++i)
        EXPECT_LT((seen - x).col(i).norm(), 1e-9 * x.col(i).norm())
            << floor << " step " << k << " example " << i;
    }
    const auto skipped = work.counts[Counter::skipped_zeros],
               there = of_cells.counts[Counter::skipped_zeros];
    EXPECT_GT(there, 0);
    EXPECT_GT(double(skipped), 0.99 * double(there));
  }
}

/// Amplitudes and uncertainties of every size, with and without likelihoods.
TEST(Heat, WhatIsKnownOfAModeHasTheBitsOfItsLikelihoods) {
  using namespace heat_lanes;
  const HeatModes heat({});
  const HeatTable& table = heat.table();
  const auto gain_by_itself = [&](double z, Index p, double u) {
    return Modes::of(P{} + std::sqrt(z * z),
                     table.s(p, p),
                     table.damping(p, p),
                     table.amplification(p, p),
                     1 / table.expected(p, p),
                     P{} + 1 / u)
        .gain[0];
  };
  Mask<double> known{};
  Index asked = 0;
  for (Index p = 0; p < 33; p += 4)
    for (int scale = -24; scale <= 3; ++scale)
      for (int size = -24; size <= 24; ++size) {
        const double u = table.expected(p, p) * std::pow(10.0, scale);
        P z{};
        for (Index k = 0; k < kWidth; ++k)
          z[k] = u * std::pow(10.0, size) * (1 + 0.9 * double(k));
        const P alone =
            gain_of(P{} + z[0], P{}, table, p, p, Uncertainty(P{} + u), known);
        const P gain =
            gain_of(z, P{}, table, p, p, Uncertainty(P{} + u), known);
        EXPECT_EQ(alone[0], gain[0]);
        for (Index k = 0; k < kWidth; ++k, ++asked)
          EXPECT_EQ(gain[k], gain_by_itself(z[k], p, u))
              << p << " " << scale << " " << size;
      }
  for (Index k = 0; k < kWidth; ++k) EXPECT_GT(known[k], asked / kWidth);
}

TEST(Heat, RectanglesAreAsManyAndAsHotAsInThePaper) {
  const AnyProblem<double> heat(problems::heat());
  const auto s = heat.sample(0, 600, kHeatRng);
  EXPECT_GE(s.x.minCoeff(), 0);
  const Vector<double> sums = s.x.colwise().sum();
  EXPECT_NEAR(sums.mean(), 351, 20);  // the mean of so many scatters by 8
  EXPECT_TRUE(
      Comparator(1e-13, 0)(s.y.colwise().sum().transpose().eval(), sums));
  Batch<double> level(s.x);
  for (Index i = 0; i < 600; ++i) level.col(i).setConstant(sums(i) / 4096);
  const auto apart = [&](const Batch<double>& a) {
    return (s.x - a).cwiseAbs().colwise().sum().mean();
  };
  EXPECT_NEAR(apart(level), 573, 30);
  EXPECT_NEAR(apart(s.y), 273, 15);
  Workspace work;
  Batch<double> seen(s.y);
  heat.forward(level, s.given, seen, work);
  Vector<double> loss(600);
  heat.loss(seen, s.y, loss);
  EXPECT_NEAR(loss.mean(), 45, 5);
}

TEST(Heat, RectanglesStayInside) {
  Batch<double> field = Batch<double>::Zero(16 * 16, 1);
  add_rectangle({.centre = {1, 15}, .half_size = {3, 4}, .strength = 2},
                16,
                field.data());
  // Rows 0..5, columns 8..15; the ramps end half a diagonal beyond the edge.
  for (Index i = 0; i < 16; ++i)
    for (Index j = 0; j < 16; ++j) {
      const double out = std::max(std::abs(double(i) + 0.5 - 3) - 3,
                                  std::abs(double(j) + 0.5 - 12) - 4);
      EXPECT_DOUBLE_EQ(field(16 * i + j),
                       2 * std::clamp(0.5 - out / std::sqrt(0.5), 0.0, 1.0));
    }
}

TEST(Heat, OptionsAreLookedAt) {
  EXPECT_THROW(AnyProblem<double>(problems::heat({.resolution = 60})),
               ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::heat({.resolution = 4})),
               ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::heat({.end_time = 0})),
               ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::heat({.noise_floor = -1})),
               ContractError);
}

// Beyond end_time 36 the finest factors are zero.
TEST(Heat, TimesThatLeaveNothing) {
  for (const double end_time : {1.0, 36.0, 64.0, 1000.0}) {
    const AnyProblem<double> heat(problems::heat({.end_time = end_time}));
    const auto s = heat.sample(0, 5, kHeatRng);
    const Batch<double> x =
        inverted<double>(heat, s.y, Batch<double>::Zero(4096, 5));
    EXPECT_TRUE(x.allFinite());
    EXPECT_LT((x - s.x).norm(), 1.05 * (s.y - s.x).norm()) << end_time;
  }
}

}  // namespace
}  // namespace physinv::test
