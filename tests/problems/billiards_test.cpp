#include "problems/billiards/billiards.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "suite/core/any_problem.h"
#include "suite/core/simd/samples.h"
#include "tests/problems/billiards_support.h"

namespace physinv {
namespace {

using test::evaluate;
using test::evaluate_one;
using test::Point;
using test::Result;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class M>
bool same_bits(const M& a, const M& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(),
                     b.data(),
                     sizeof(a(0, 0)) * static_cast<std::size_t>(a.size())) == 0;
}

/// A mix of hits, misses and odd inputs.
template <class T>
void mixed_batch(Index n, Batch<T>& x, Batch<T>& given) {
  Stream s = Rng::root("test/billiards", 1).stream();
  x.resize(2, n), given.resize(2, n);
  for (Index i = 0; i < n; ++i) {
    x(0, i) = T(s.uniform(-0.5, 3)), x(1, i) = T(s.uniform(-1.5, 1.5));
    given(0, i) = T(1), given(1, i) = T(s.uniform());
    if (i % 11 == 5) x.col(i).setZero();
    if (i % 17 == 3) x(1, i) = T(kNan);
  }
}

// ---- plateau, hazards ---------------------------------------------------

const std::vector<std::pair<Point, Point>> kMisses = {
    {{1, 0}, {1, 0.9}},
    {{0.24, 0}, {1, 0.5}},
    {{0, 0}, {1, 0.5}},
    {{-1, 0}, {1, 0.5}},
    {{1e-160, 0}, {1, 0.5}},
    {{1e-160, 1e-161}, {1, 0.6}},
    {{3e-162, 0}, {1, 0.5}},
    {{1, 0}, {1, 0.95}},
    {{1, 0}, {1, 0.1}},
    {{0.1, 0}, {1, 0.5}},
    {{5e-324, 0}, {1, 0.5}},
    {{0, 1}, {1, 0.5}},
    {{-0.0, -0.0}, {1, 0.5}}};

template <class T>
void expect_miss(const Result<T>& r, Index i, T ball_x, T ball_y) {
  EXPECT_EQ(r.y(0, i), ball_x);
  EXPECT_EQ(r.y(1, i), ball_y);
  const Batch<T> zero2 = Batch<T>::Zero(2, 1), zero4 = Batch<T>::Zero(4, 1);
  EXPECT_TRUE(same_bits(Batch<T>(r.x_bar.col(i)), zero2)) << r.x_bar.col(i);
  EXPECT_TRUE(same_bits(Batch<T>(r.jacobian.col(i)), zero4));
}

template <class T>
class BilliardsIn : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(BilliardsIn, Precisions);

TYPED_TEST(BilliardsIn, MissesAreAStrictPlateau) {
  using T = TypeParam;
  for (const auto& [v, ball] : kMisses) {
    SCOPED_TRACE(testing::Message() << v[0] << " " << v[1] << " " << ball[1]);
    expect_miss(evaluate_one<T>(v, ball), 0, T(ball[0]), T(ball[1]));
    EXPECT_FALSE(collide<T>({T(v[0]), T(v[1])}, {T(ball[0]), T(ball[1])}).hit);
  }
}

TYPED_TEST(BilliardsIn, TooFastIsAMissAndFastIsNot) {
  using T = TypeParam;
  const T huge = std::numeric_limits<T>::max();
  for (T speed : {huge, T(huge / 4), T(std::sqrt(huge) * 2)}) {
    Batch<T> x(2, 1), given(2, 1);
    x << speed, -speed / 8;
    given << T(1), T(0.5);
    expect_miss(evaluate<T>(x, given), 0, T(1), T(0.5));
  }
  const auto r = evaluate_one<T>({1e3, 0}, {1, 0.5});
  EXPECT_NEAR(r.y(0, 0), 1 + 2.25 * (1e3 - 0.4 * 0.6), 1e-3);
  EXPECT_TRUE(r.x_bar.allFinite());
  EXPECT_TRUE(r.jacobian.allFinite());
}

TYPED_TEST(BilliardsIn, NonFiniteInputStaysInItsColumn) {
  using T = TypeParam;
  for (double bad : {kNan, kInf, -kInf}) {
    for (int row = 0; row < 4; ++row) {
      Batch<T> x(2, 9), given(2, 9);
      mixed_batch<T>(9, x, given);
      x.col(3) << T(1), T(0.1);
      const auto before = evaluate<T>(x, given);
      (row < 2 ? x(row, 4) : given(row - 2, 4)) = T(bad);
      const auto r = evaluate<T>(x, given);
      EXPECT_TRUE(r.y.col(4).array().isNaN().all());
      EXPECT_TRUE(r.jacobian.col(4).array().isNaN().all());
      EXPECT_TRUE(r.x_bar.col(4).array().isNaN().all());
      for (Index i : {0, 1, 2, 5, 6, 7, 8}) {
        EXPECT_TRUE(same_bits(Batch<T>(r.y.col(i)), Batch<T>(before.y.col(i))));
        EXPECT_TRUE(
            same_bits(Batch<T>(r.x_bar.col(i)), Batch<T>(before.x_bar.col(i))));
      }
    }
  }
}

TYPED_TEST(BilliardsIn, NoFloatingPointExceptions) {
  using T = TypeParam;
  const AnyProblem<T> problem(problems::billiards());
  Batch<T> x, given;
  mixed_batch<T>(101, x, given);
  for (std::size_t i = 0; i < kMisses.size(); ++i) {
    const auto& [v, ball] = kMisses[i];
    x.col(static_cast<Index>(i)) << T(v[0]), T(v[1]);
    given.col(static_cast<Index>(i)) << T(ball[0]), T(ball[1]);
  }
  x(0, 20) = T(kInf), x(0, 21) = std::numeric_limits<T>::max();
  given(1, 22) = T(kNan), given(0, 23) = T(-kInf);
  x.col(24) << T(std::numeric_limits<T>::max()), T(-kInf);
  Batch<T> y(2, 101), g(2, 101), x_bar(2, 101), j(4, 101);
  g.setOnes();
  expect_miss(evaluate_one<T>({1, 0}, {1, 0.9}), 0, T(1), T(0.9));
  g.col(2).setConstant(T(kInf));  // a miss ignores its cotangent
  Tape tape;
  Workspace work;
  std::feclearexcept(FE_ALL_EXCEPT);
  problem.forward(x, given, y, work);
  problem.linearize(x, given, y, tape);
  problem.pullback(tape, g, x_bar, work);
  problem.jacobian(x, given, j, work);
  EXPECT_EQ(std::fetestexcept(FE_INVALID | FE_DIVBYZERO), 0);
  EXPECT_EQ(x_bar(0, 2), T(0));
}

TEST(Billiards, GrazingStaysContinuousWhileTheSlopeGrows) {
  double last = 0;
  for (int k = 2; k < 12; ++k) {
    const double h = 0.9 - std::pow(10.0, -k);
    const auto r = evaluate_one<double>({1, 0}, {1, h});
    const auto hit = collide<double>({1, 0}, {1, h});
    ASSERT_TRUE(hit.hit) << h;
    const double plateau = 0.5 * (1 + (h - 0.5) * (h - 0.5));
    EXPECT_LT(std::abs(r.loss(0) - plateau), 4 * std::pow(10.0, -k / 2.0));
    EXPECT_GT(r.x_bar.norm(), last);
    last = r.x_bar.norm();
  }
  const auto r = evaluate_one<double>({1, 0}, {1, 0.899999});
  EXPECT_NEAR(r.x_bar.norm(), 6.0e2, 0.05e2);
  EXPECT_NEAR(r.jacobian.cwiseAbs().maxCoeff(), 1.5e3, 0.05e3);
}

// ---- derivatives --------------------------------------------------------

TEST(Billiards, JacobianAgreesWithCentralDifferences) {
  const AnyProblem<double> problem(problems::billiards());
  const auto samples =
      problem.sample_labelled(0, 400, Rng::root("test/billiards", 2));
  const auto r = evaluate<double>(samples.x, samples.given);
  Workspace work;
  int compared = 0;
  for (int c = 0; c < 2; ++c) {
    const double step = 1e-6;
    Batch<double> up = samples.x, down = samples.x;
    Batch<double> y_up(2, 400), y_down(2, 400);
    up.row(c).array() += step, down.row(c).array() -= step;
    problem.forward(up, samples.given, y_up, work);
    problem.forward(down, samples.given, y_down, work);
    for (Index i = 0; i < 400; ++i) {
      const auto at =
          collide<double>({samples.x(0, i), samples.x(1, i)},
                          {samples.given(0, i), samples.given(1, i)});
      if (!at.hit || at.normal_speed < 0.05) continue;
      ++compared;
      for (int row = 0; row < 2; ++row)
        EXPECT_NEAR((y_up(row, i) - y_down(row, i)) / (2 * step),
                    r.jacobian(row + 2 * c, i),
                    1e-4);
    }
  }
  EXPECT_GT(compared, 400);
}

TYPED_TEST(BilliardsIn, PullbackIsTheTransposedJacobian) {
  using T = TypeParam;
  const AnyProblem<T> problem(problems::billiards());
  const auto s =
      problem.sample_labelled(0, 333, Rng::root("test/billiards", 3));
  const Batch<T> x = s.x.template cast<T>(), given = s.given.template cast<T>();
  const Batch<T> g = Batch<T>::Random(2, 333), dx = Batch<T>::Random(2, 333);
  const auto r = evaluate<T>(x, given, &g);
  const double eps = std::numeric_limits<T>::epsilon();
  for (Index i = 0; i < 333; ++i) {
    const Eigen::Map<const Eigen::Matrix<T, 2, 2>> j(r.jacobian.col(i).data());
    const Eigen::Vector2d jv = (j * dx.col(i)).template cast<double>();
    const Eigen::Vector2d gd = g.col(i).template cast<double>();
    const double left = gd.dot(jv);
    const double right = r.x_bar.col(i).template cast<double>().dot(
        dx.col(i).template cast<double>());
    EXPECT_NEAR(left, right, 8 * eps * (1 + double(j.norm())));
  }
}

// ---- batches ------------------------------------------------------------

TYPED_TEST(BilliardsIn, BitsDependNeitherOnPositionNorOnBatch) {
  using T = TypeParam;
  constexpr Index n = 75;
  Batch<T> x, given;
  mixed_batch<T>(n, x, given);
  const auto all = evaluate<T>(x, given);
  EXPECT_TRUE(same_bits(all.y, all.y_forward));

  std::vector<Index> order;
  for (Index i = 0; i < n; ++i) order.push_back(i * 31 % n);
  for (Index size : {n, Index(40), Index(7), Index(1)}) {
    const Index step = size == 1 ? 1 : n;
    for (Index first = 0; first + size <= n; first += step) {
      Batch<T> xs(2, size), gs(2, size);
      for (Index i = 0; i < size; ++i) {
        xs.col(i) = x.col(order[first + i]);
        gs.col(i) = given.col(order[first + i]);
      }
      const auto some = evaluate<T>(xs, gs);
      const auto pick = [&](const Batch<T>& m) {
        Batch<T> out(m.rows(), size);
        for (Index i = 0; i < size; ++i) out.col(i) = m.col(order[first + i]);
        return out;
      };
      EXPECT_TRUE(same_bits(some.y, pick(all.y)));
      EXPECT_TRUE(same_bits(some.y_forward, pick(all.y)));
      EXPECT_TRUE(same_bits(some.x_bar, pick(all.x_bar)));
      EXPECT_TRUE(same_bits(some.jacobian, pick(all.jacobian)));
    }
  }
}

TYPED_TEST(BilliardsIn, CountsWhatItSkips) {
  using T = TypeParam;
  Batch<T> x, given;
  mixed_batch<T>(61, x, given);
  const auto r = evaluate<T>(x, given);
  std::uint64_t hits = 0, broken = 0;
  for (Index i = 0; i < 61; ++i) {
    hits += collide<T>({x(0, i), x(1, i)}, {given(0, i), given(1, i)}).hit;
    broken += std::isnan(x(1, i));
  }
  EXPECT_GT(hits, 5u);
  EXPECT_EQ(r.linearized[Counter::skipped_events], hits);
  EXPECT_EQ(r.pulled[Counter::skipped_vjp], 61 - hits - broken);
}

TYPED_TEST(BilliardsIn, EmptyBatchesAndMemory) {
  using T = TypeParam;
  const AnyProblem<T> problem(problems::billiards());
  Batch<T> x, given;
  Tape tape;
  Workspace work;
  for (Index n : {128, 0, 3, 128}) {
    mixed_batch<T>(n, x, given);
    Batch<T> y(2, n), x_bar(2, n);
    problem.linearize(x, given, y, tape);
    const std::size_t bytes = tape.bytes();
    problem.pullback(tape, y, x_bar, work);
    EXPECT_EQ(tape.bytes(), bytes);
    EXPECT_LE(bytes, 128 * (4 + 1) * sizeof(T) + kAlignment);
  }
  EXPECT_EQ(work.bytes(), 0u);
}

TEST(Billiards, ChecksItsContract) {
  const AnyProblem<double> problem(problems::billiards());
  Batch<double> x(2, 3), given(2, 2), y(2, 3);
  Workspace work;
  EXPECT_THROW(problem.forward(x, given, y, work), ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::billiards({.drag = 0})),
               ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::billiards({.ball_x = 0.3})),
               ContractError);
}

// ---- events -------------------------------------------------------------

TEST(Billiards, OneEventIsAllThereIs) {
  const auto check = [](Point v, Point ball, const BilliardsOptions& o) {
    const auto path = simulate_events(v, ball, o);
    const auto fast = collide<double>(v, ball, o);
    EXPECT_EQ(path.events, fast.hit ? 1 : 0);
    if (!fast.hit) {
      EXPECT_EQ(path.final_ball, ball);
      return;
    }
    const double scale = std::hypot(v[0], v[1]) / fast.normal_speed;
    for (int i = 0; i < 2; ++i)
      EXPECT_NEAR(path.final_ball[i],
                  fast.final_ball[i],
                  1e-13 * (1 + scale) * (1 + std::abs(path.final_ball[i])));
  };
  Stream s = Rng::root("test/billiards", 4).stream();
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const BilliardsOptions o{.elasticity = i % 3 == 0 ? 0.8 : s.uniform()};
    const Point v = {s.uniform(-0.5, 3), s.uniform(-1, 1)};
    const Point ball = {1, s.uniform()};
    check(v, ball, o);
    hits += collide<double>(v, ball, o).hit;
  }
  EXPECT_GT(hits, 1000);
  for (const auto& [v, ball] : kMisses) check(v, ball, {});
}

TEST(Billiards, CollisionKeepsMomentumAndElasticity) {
  const auto c = collide<double>({1.2, -0.9}, {1, 0});
  ASSERT_TRUE(c.hit);
  double closing = 0, opening = 0;
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(c.cue_velocity_after[i] + c.ball_velocity_after[i],
                c.cue_velocity_before[i],
                1e-15);
    closing += c.normal[i] * c.cue_velocity_before[i];
    opening +=
        c.normal[i] * (c.ball_velocity_after[i] - c.cue_velocity_after[i]);
  }
  EXPECT_NEAR(opening, 0.8 * closing, 1e-14);
}

// ---- data ---------------------------------------------------------------

TEST(Billiards, ExactSolutionsHitTheTarget) {
  const AnyProblem<double> problem(problems::billiards());
  const auto s = problem.sample(0, 1000, Rng::root("test/billiards", 5));
  const auto r = evaluate<double>(s.x, s.given);
  EXPECT_LT(r.loss.maxCoeff(), 1e-24);
  EXPECT_NEAR(exact_velocity({1, 0.5})[0], 1 / 2.25 + 0.6 * 0.4, 1e-15);
  for (double h : {0.0, 1.0}) {
    const Point v = exact_velocity({1, h});
    EXPECT_NEAR(std::hypot(v[0], v[1]), 2.0885, 5e-5);
    EXPECT_NEAR(std::abs(std::atan2(v[1], v[0])) * 180 / M_PI, 46.6, 0.05);
  }
}

TEST(Billiards, SamplesHaveTheirDistributions) {
  const AnyProblem<double> problem(problems::billiards());
  constexpr Index n = 20000;
  const auto s = problem.sample(0, n, Rng::root("test/billiards", 8));
  EXPECT_TRUE((s.given.row(0).array() == 1).all());
  EXPECT_TRUE((s.y.row(0).array() == 2).all());
  EXPECT_TRUE((s.y.row(1).array() == 0.5).all());
  EXPECT_GE(s.given.row(1).minCoeff(), 0);
  EXPECT_LT(s.given.row(1).maxCoeff(), 1);
  EXPECT_NEAR(s.given.row(1).mean(), 0.5, 0.01);

  Batch<double> start = problem.start().replicate(1, n), y(2, n);
  Workspace work;
  problem.forward(start, s.given, y, work);
  const auto missed = (y.row(0).array() == 1).count();
  EXPECT_NEAR(1 - double(missed) / n, 0.8, 0.01);
  for (Index i = 0; i < n; ++i)
    ASSERT_EQ(y(0, i) != 1, std::abs(s.given(1, i) - 0.5) < 0.4);

  const auto l = problem.sample_labelled(0, n, Rng::root("test/billiards", 8));
  EXPECT_GE(l.x.row(0).minCoeff(), 0.5);
  EXPECT_LT(l.x.row(0).maxCoeff(), 1.5);
  EXPECT_GE(l.x.row(1).minCoeff(), -0.5);
  EXPECT_LT(l.x.row(1).maxCoeff(), 0.5);
  EXPECT_NEAR(l.x.row(0).mean(), 1, 0.01);
  EXPECT_NEAR(l.x.row(1).mean(), 0, 0.01);
  EXPECT_TRUE(same_bits(l.y, evaluate<double>(l.x, l.given).y));
}

// ---- lanes --------------------------------------------------------------

TYPED_TEST(BilliardsIn, LanesTransposeThereAndBack) {
  using T = TypeParam;
  constexpr int W = kLanes<T>;
  for (Index rows : {1, 2, 3, 4}) {
    const Batch<T> in = Batch<T>::Random(rows, 2 * W + 3);
    Batch<T> out = Batch<T>::Zero(rows, 2 * W + 3);
    Eigen::Ref<Batch<T>> view(out);
    for (Index b = 0; b < Lanes<T>::blocks(in.cols()); ++b) {
      Pack<T> packs[4];
      Lanes<T> lanes(packs, rows);
      lanes.load(in, b * W, T(7));
      for (Index r = 0; r < rows; ++r)
        for (Index k = 0; k < W; ++k) {
          const Index i = b * W + k;
          EXPECT_EQ(packs[r][k], i < in.cols() ? in(r, i) : T(7));
        }
      lanes.store(view, b * W);
    }
    EXPECT_TRUE(same_bits(in, out));
  }
}

}  // namespace
}  // namespace physinv
