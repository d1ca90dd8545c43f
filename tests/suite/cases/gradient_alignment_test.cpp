#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "problems/noisy_absolute/noise_lanes.h"
#include "suite/cases/jpo/gradient_alignment/theory.h"
#include "suite/core/any_problem.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/alignment.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr double kSnr = 0.1;

// ---- theory ----------------------------------------------------------------

TEST(AlignmentTheory, OneExampleNeedsNoVote) {
  for (const double snr : {0.01, 0.1, 1.0, 3.0}) {
    EXPECT_NEAR(align_vote(1, snr), align_one(snr), 1e-14);
    EXPECT_NEAR(align_sum(1, snr), align_one(snr), 1e-14);
    // A tie leaves a pair where one alone was.
    EXPECT_NEAR(align_vote(2, snr), align_one(snr), 1e-14);
  }
}

TEST(AlignmentTheory, ProbabilitiesForManyAndExtremeRatios) {
  for (const Index n : {1, 2, 7, 256, 1000, 100000}) {
    for (const double snr : {0.0, 1e-3, 0.1, 1.0, 5.0, 40.0}) {
      const double p = align_vote(n, snr);
      EXPECT_GE(p, 0.5 - 1e-9) << n << " " << snr;
      EXPECT_LE(p, 1) << n << " " << snr;
      EXPECT_TRUE(std::isfinite(align_vote_normal(n, snr)));
    }
    EXPECT_NEAR(align_vote(n, 0), 0.5, 1e-9);
  }
  EXPECT_EQ(align_vote(1000, 40), 1);
  EXPECT_EQ(align_vote_normal(10, 40), 1);
}

TEST(AlignmentTheory, FirstOrders) {
  EXPECT_NEAR(align_one_first_order(1e-4), align_one(1e-4), 1e-11);
}

// The misprint costs a factor sqrt(2) in the argument.
TEST(AlignmentTheory, TheVoteIsNormalForManyWithTheTwo) {
  const double exact = align_vote(1001, kSnr / 4);
  EXPECT_NEAR(align_vote_normal(1001, kSnr / 4), exact, 2e-3);
  EXPECT_GT(align_vote_printed(1001, kSnr / 4), exact + 0.05);
  // Voting is summing with a ratio smaller by sqrt(2 / pi).
  EXPECT_NEAR(align_vote(1001, kSnr / 4),
              align_sum(1001, kSnr / 4 * std::sqrt(2 / std::numbers::pi)),
              2e-3);
}

TEST(AlignmentTheory, ResponsesFallFromOneAndSettle) {
  const Response clamped{6.4, 12.9, true};
  const auto rho = response_curve(100000, clamped);
  EXPECT_EQ(rho.front(), 1);
  for (std::size_t i = 1; i < rho.size(); ++i) ASSERT_LE(rho[i], rho[i - 1]);
  EXPECT_NEAR(rho[99999], rho[49999], 1e-4);
  EXPECT_GT(rho.back(), 0.5);
}

TEST(AlignmentTheory, TheFitFindsItsOwnCurve) {
  const std::vector<Index> sizes{1, 2, 4, 8, 16, 32, 64, 128, 256};
  const auto rho = response_curve(256, {4.25, 7.5});
  std::vector<double> values;
  for (const Index n : sizes)
    values.push_back(rho[static_cast<std::size_t>(n - 1)]);
  const auto fit = fit_response(sizes, values);
  EXPECT_EQ(fit.response.complexity, 4.25);
  EXPECT_EQ(fit.response.plasticity, 7.5);
  EXPECT_LT(fit.rms, 1e-14);
}

TEST(AlignmentTheory, NoiseMixesRightAndWrong) {
  EXPECT_EQ(align_combined(1, 0.8), 0.8);
  EXPECT_EQ(align_combined(0.5, 0.8), 0.5);
}

// ---- lanes -----------------------------------------------------------------

template <class T>
class LaneMath : public testing::Test {
 protected:
  /// Largest |ours - exact| over [lo, hi], relative if asked.
  template <class F, class G>
  double error(F&& ours, G&& exact, double lo, double hi, bool relative) {
    double worst = 0;
    for (int i = 0; i <= 20000; ++i) {
      const T x = static_cast<T>(lo + (hi - lo) * i / 20000);
      const Pack<T> y = ours(x - Pack<T>{});
      const double e = exact(static_cast<double>(x));
      const double off = std::abs(static_cast<double>(y[1]) - e);
      worst = std::max(worst, relative ? off / std::abs(e) : off);
    }
    return worst;
  }
  static constexpr double kEps = std::numeric_limits<T>::epsilon();
};

using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(LaneMath, Types);

TYPED_TEST(LaneMath, IsAccurate) {
  using T = TypeParam;
  const double eps = this->kEps;
  const auto sine = [](double t) {
    return std::sin(2 * std::numbers::pi * (t - std::round(t)));
  };
  EXPECT_LT(this->error(
                [](Pack<T> t) { return sin_turns(t); }, sine, -320, 320, false),
            16 * eps);
  EXPECT_LT(this->error([](Pack<T> x) { return exp_lanes(x); },
                        [](double x) { return std::exp(x); },
                        -87,
                        87,
                        true),
            4 * eps);
  EXPECT_LT(this->error([](Pack<T> x) { return tanh_lanes(x); },
                        [](double x) { return std::tanh(x); },
                        -30,
                        30,
                        false),
            2 * eps);
}

TYPED_TEST(LaneMath, EndsAndNan) {
  using T = TypeParam;
  constexpr T kInf = std::numeric_limits<T>::infinity();
  constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
  const auto all = [](T x) { return x - Pack<T>{}; };
  EXPECT_EQ(tanh_lanes(all(kInf))[0], 1);
  EXPECT_EQ(tanh_lanes(all(-kInf))[0], -1);
  EXPECT_EQ(sign_lanes(all(-3))[0], -1);
  EXPECT_EQ(sign_lanes(all(0))[0], 0);
  EXPECT_TRUE(std::isnan(sign_lanes(all(kNan))[0]));
  EXPECT_TRUE(std::isnan(sin_turns(all(kNan))[0]));
  EXPECT_TRUE(std::isnan(exp_lanes(all(kNan))[0]));
  EXPECT_TRUE(std::isnan(tanh_lanes(all(kNan))[0]));
}

template <class T>
StreamLanes<T> streams(std::uint64_t seed, int from = 0) {
  return StreamLanes<T>([=](int k) {
    return Rng::root("gradient_alignment_test", seed)
        .child(static_cast<std::uint64_t>(from + k))
        .stream();
  });
}

// The same numbers in any lane and in either precision.
TEST(StreamLanes, LanesAreStreams) {
  auto single = streams<float>(1), shifted = streams<float>(1, 1);
  auto wide = streams<double>(1);
  for (int i = 0; i < 100; ++i) {
    const auto a = single.uniform(), b = shifted.uniform();
    const auto c = wide.uniform();
    EXPECT_EQ(a[1], b[0]);
    EXPECT_EQ(static_cast<double>(a[1]), c[1]);
    EXPECT_NE(a[0], a[1]);
  }
}

TEST(StreamLanes, IsUniform) {
  auto random = streams<double>(2);
  constexpr int kCount = 100000;
  double sum = 0, square = 0, product = 0, last = 0;
  for (int i = 0; i < kCount; ++i) {
    const double u = random.uniform()[0];
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u, square += u * u, product += u * last, last = u;
  }
  EXPECT_NEAR(sum / kCount, 1. / 2, 5e-3);
  EXPECT_NEAR(square / kCount, 1. / 3, 5e-3);
  EXPECT_NEAR(product / kCount, 1. / 4, 5e-3);
}

TEST(StreamLanes, ThreeFromTwoDrawsAreUniformAndIndependent) {
  auto random = streams<double>(5);
  constexpr int kCount = 100000;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kCount; ++i) {
    const auto three = random.whole_three();
    const Eigen::Vector3d u(
        three.a[0] * 0x1p-21, three.b[0] * 0x1p-21, three.c[0] * 0x1p-24 + 0.5);
    ASSERT_GE(u.minCoeff(), 0);
    ASSERT_LT(u.maxCoeff(), 1);
    sum += u, products += u * u.transpose();
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(sum(i) / kCount, 1. / 2, 5e-3);
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(products(i, j) / kCount, i == j ? 1. / 3 : 1. / 4, 5e-3);
  }
}

// ---- noise -----------------------------------------------------------------

TEST(NoiseLanes, HasItsLevel) {
  // The noise is a sum of many sines: mean 0, mean square a^2 / 2.
  const NoiseLanes<double> noise({});
  auto random = streams<double>(3);
  const Pack<double> level = 3 - Pack<double>{};
  constexpr int kCount = 20000;
  double sum = 0, square = 0;
  for (int i = 0; i < kCount; ++i) {
    const double g = noise.noise(random, level)[0];
    sum += g, square += g * g;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.1);
  EXPECT_NEAR(square / kCount, 4.5, 0.2);
}

// Drawn by the problem or in lanes: the same distribution.
TEST(NoiseLanes, DrawsWhatTheProblemDraws) {
  const NoisyAbsoluteOptions options{
      .solution = Solution::sine, .decades = 2, .snr = 0.5};
  constexpr Index kCount = 4000;
  const AnyProblem<double> problem(problems::noisy_absolute(options));
  const auto set = problem.sample_labelled(0, kCount, Rng::root("noise", 1));
  Batch<double> y(1, kCount), slope(1, kCount);
  Tape tape;
  Workspace work;
  problem.linearize(set.x, set.given, y, tape);
  problem.pullback(tape, Batch<double>::Ones(1, kCount), slope, work);
  const NoiseLanes<double> noise(options);
  auto random = streams<double>(4);
  double right = 0, right_lanes = 0, level = 0, level_lanes = 0;
  for (Index i = 0; i < kCount; ++i) {
    const double away = set.x(0, i) - set.given(1, i);
    right += slope(0, i) * away > 0;
    level += std::log(set.given(2, i));
    EXPECT_NEAR(set.given(1, i), std::sin(2 * set.given(0, i)), 1e-12);
    const auto p = noise.draw(random);
    EXPECT_NEAR(p.solution[0], std::sin(2 * p.gamma[0]), 1e-12);
    right_lanes += (p.lambda + noise.noise(random, p.level))[0] > 0;
    level_lanes += std::log(p.lambda[0]);
  }
  EXPECT_NEAR(right / kCount, align_one(0.5), 0.03);
  EXPECT_NEAR(right_lanes / kCount, align_one(0.5), 0.03);
  EXPECT_NEAR(level / kCount, level_lanes / kCount, 0.25);
}

TEST(NoisyAbsolute, NoNoiseIsLevelZero) {
  EXPECT_EQ(noise_level(Vector<double>::Zero(4), Vector<double>::Ones(4)), 0);
  EXPECT_EQ(noise_level(Vector<double>(0), Vector<double>(0)), 0);
  const NoisyAbsoluteOptions silent{.terms = 0},
      quiet{.omega_min = 0, .omega_max = 0};
  for (const auto& options : {silent, quiet}) {
    auto random = streams<float>(5);
    const Pack<float> one = 1 - Pack<float>{};
    EXPECT_EQ(NoiseLanes<float>(options).noise(random, one)[0], 0);
    const auto set = AnyProblem<double>(problems::noisy_absolute(options))
                         .sample(0, 3, Rng::root("quiet", 1));
    EXPECT_TRUE(set.given.allFinite());
    EXPECT_TRUE(set.y.allFinite());
  }
  EXPECT_EQ(AnyProblem<float>(problems::noisy_absolute(silent)).shape().given,
            3);
}

// ---- clipping --------------------------------------------------------------

// A threshold below all gradients leaves their signs, one above all leaves them
// as they are.
TEST(Alignment, AClippedSumIsTheVoteOrTheSum) {
  const auto count = [](double clip) {
    AlignmentBlock<double, NoiseLanes> block(
        {.data = {.solution = Solution::zero, .decades = 2, .snr = 0.1},
         .network = {},
         .clip = clip},
        8);
    Index votes = 0, sums = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      const auto shares = block.run(streams<double>(seed));
      votes += shares.clipped[0] != shares.vote[0];
      sums += shares.clipped[0] != shares.sum[0];
    }
    return std::pair(votes, sums);
  };
  const auto low = count(0x1p-30), high = count(1e9);
  EXPECT_EQ(low.first, 0);
  EXPECT_GT(low.second, 0);
  EXPECT_GT(high.first, 0);
  EXPECT_EQ(high.second, 0);
}

// ---- one step --------------------------------------------------------------

struct Responses {
  Batch<double> gamma, g, x, delta;  ///< examples x lanes
  Batch<double> theta;               ///< parameters x lanes
};

template <class T>
Responses respond(const TinyNetOptions& options, Index n) {
  const auto net = one_step<T>(options);
  auto random = streams<T>(6);
  net->initialize(random);
  Buffer memory;
  const auto size = static_cast<std::size_t>(4 * n) * sizeof(Pack<T>);
  auto* gamma = static_cast<Pack<T>*>(memory.reserve(size));
  auto *g = gamma + n, *x = gamma + 2 * n, *delta = gamma + 3 * n;
  const T range = static_cast<T>(options.range);
  for (Index i = 0; i < n; ++i) {
    gamma[i] = random.uniform(-range, range);
    g[i] = sign_lanes(random.uniform(T(-1), T(1)));
  }
  net->predict(gamma, n, x);
  net->respond(g, delta);
  const auto batch = [](const Pack<T>* p, Index rows) {
    return Batch<double>::NullaryExpr(rows, 4, [=](Index i, Index k) {
      return static_cast<double>(p[i][k]);
    });
  };
  return {batch(gamma, n),
          batch(g, n),
          batch(x, n),
          batch(delta, n),
          batch(net->parameters().data(),
                static_cast<Index>(net->parameters().size()))};
}

const TinyNetOptions kTanh{.hidden = {32, 32, 32},
                           .activation = TinyActivation::tanh,
                           .scale = 40,
                           .range = 1};

// -J J^T g of a ReLU network: examples meet in the units both activate.
TEST(OneStep, SecondPassHasTheSignsOfTheFirstOrder) {
  constexpr Index kExamples = 33, kUnits = 64;
  const auto r = respond<double>({}, kExamples);
  for (Index k = 0; k < 4; ++k) {
    const auto theta = r.theta.col(k);
    for (Index i = 0; i < kExamples; ++i) {
      double first_order = 0;
      for (Index j = 0; j < kExamples; ++j) {
        double kernel = 1;
        const double a = r.gamma(i, k), b = r.gamma(j, k);
        for (Index u = 0; u < kUnits; ++u) {
          const double w = theta(u), c = theta(kUnits + u);
          const double v = theta(2 * kUnits + u);
          const double hi = w * a + c, hj = w * b + c;
          if (hi > 0 && hj > 0) kernel += hi * hj + v * v * (a * b + 1);
        }
        first_order -= 1e-3 * kernel * r.g(j, k);
      }
      EXPECT_NEAR(
          r.delta(i, k), first_order, 2e-2 * std::abs(first_order) + 3e-4);
      if (std::abs(first_order) > 1e-3) {
        EXPECT_GT(r.delta(i, k) * first_order, 0);
      }
    }
  }
}

// One example: J J^T > 0, whatever the network.
TEST(OneStep, AloneIsAlwaysAligned) {
  for (const auto& options : {TinyNetOptions{}, kTanh}) {
    const auto r = respond<float>(options, 1);
    EXPECT_LT((r.delta.array() * r.g.array()).maxCoeff(), 0);
  }
}

TEST(OneStep, NodesAreExactToRounding) {
  TinyNetOptions direct = kTanh;
  direct.nodes = false;
  const auto full = respond<double>(direct, 100);
  const auto few = respond<double>(kTanh, 100);
  EXPECT_TRUE(Comparator(1e-12, 0)(few.x, full.x));
  EXPECT_TRUE(Comparator(1e-10, 0)(few.delta, full.delta));
  const auto single = respond<float>(kTanh, 100);
  const auto single_full = respond<float>(direct, 100);
  EXPECT_TRUE(Comparator(1e-6, 0)(single.theta, full.theta));
  EXPECT_TRUE(Comparator(1e-5, 0)(single.x, full.x));
  EXPECT_TRUE(Comparator(1e-3, 0)(single.delta, full.delta));
  EXPECT_TRUE(Comparator(1e-3, 0)(single_full.delta, full.delta));
}

TEST(OneStep, WeightsAndBiasesFillTheirRange) {
  const auto r = respond<double>(kTanh, 1);
  const auto fans = one_step<double>(kTanh)->fan_in();
  ASSERT_EQ(static_cast<Index>(fans.size()), r.theta.rows());
  double largest = 0;
  for (Index i = 0; i < r.theta.rows(); ++i)
    largest =
        std::max(largest,
                 r.theta.row(i).cwiseAbs().maxCoeff() *
                     std::sqrt(double(fans[static_cast<std::size_t>(i)])));
  EXPECT_LE(largest, 1);
  EXPECT_GT(largest, 0.99);
}

// ---- the stage -------------------------------------------------------------

Arrays measure(const AlignmentOptions<NoiseLanes>& options,
               Index n,
               Index repetitions,
               int threads = 1,
               Precision precision = Precision::f32) {
  const MeasureAlignment<NoiseLanes> stage(options);
  Threads pool(threads);
  const Rng root = Rng::root("gradient_alignment_test", 7);
  Oracle oracle(problems::noisy_absolute(), n, root, stage.needs(), &pool);
  Probe probe(oracle, repetitions);
  const Setting setting;
  StageRun run{.oracle = oracle,
               .probe = probe,
               .setting = setting,
               .previous = nullptr,
               .network_init = root.child("network/init"),
               .batches = root.child("batches"),
               .method = root.child("method"),
               .iterations = repetitions,
               .precision = precision,
               .threads = &pool};
  return stage.run(run).arrays;
}

const AlignmentOptions<NoiseLanes> kKnown{
    .data = {.solution = Solution::zero, .level = 10, .snr = kSnr}};
const AlignmentOptions<NoiseLanes> kSineStep{.network = TinyNetOptions{}};

TEST(MeasureAlignment, FewRepetitionsAreAPrefixForAnyThreads) {
  for (const auto& options : {kKnown, kSineStep}) {
    const auto many = measure(options, 5, 30);
    const auto few = measure(options, 5, 11, 3);
    const auto threaded = measure(options, 5, 30, 3);
    EXPECT_EQ(many.size(), options.network ? 3U : 2U);
    for (const auto& [name, values] : many) {
      EXPECT_EQ(values, threaded.at(ArrayKey::own(name))) << name;
      EXPECT_EQ(values.topRows(11), few.at(ArrayKey::own(name))) << name;
      EXPECT_GE(values.minCoeff(), 0);
      EXPECT_LE(values.maxCoeff(), 1);
    }
    EXPECT_NE(many.at("sum"), measure(options, 6, 30).at("sum"));
  }
}

TEST(MeasureAlignment, SumAndVoteFollowTheTheory) {
  for (const auto precision : {Precision::f32, Precision::f64}) {
    for (const Index n : {1, 8, 64}) {
      constexpr Index kRepetitions = 400;
      const auto found = measure(kKnown, n, kRepetitions, 1, precision);
      const double sum = found.at("sum").mean();
      const double vote = found.at("vote").mean();
      const double width = 4 * std::sqrt(0.25 / kRepetitions);
      EXPECT_NEAR(sum, align_sum(n, kSnr), width);
      EXPECT_NEAR(vote, align_vote(n, kSnr), width);
      if (n == 1) {
        EXPECT_EQ(found.at("sum"), found.at("vote"));
      }
    }
  }
}

TEST(MeasureAlignment, OneNoiseFreeExampleIsAlwaysAligned) {
  EXPECT_EQ(measure(kSineStep, 1, 100).at("noise_free").minCoeff(), 1);
  const AlignmentOptions<NoiseLanes> linear{
      .data = {.solution = Solution::linear, .gamma = 1, .terms = 0},
      .network = kTanh};
  const auto alone = measure(linear, 1, 100);
  EXPECT_EQ(alone.size(), 1U);
  EXPECT_EQ(alone.at("noise_free").minCoeff(), 1);
  const double many = measure(linear, 64, 100).at("noise_free").mean();
  EXPECT_GT(many, 0.7);
  EXPECT_LT(many, 0.9);
}

TEST(MeasureAlignment, PrecisionsAgreeUpToRareSigns) {
  const auto single = measure(kSineStep, 16, 100);
  const auto wide = measure(kSineStep, 16, 100, 1, Precision::f64);
  for (const auto& [name, values] : single)
    EXPECT_NEAR(values.mean(), wide.at(ArrayKey::own(name)).mean(), 5e-3)
        << name;
}

}  // namespace
}  // namespace physinv::test
