#include "suite/core/oracle.h"

#include <gtest/gtest.h>

#include "suite/core/check.h"
#include "suite/core/threads.h"
#include "tests/support/bits.h"
#include "tests/support/quadratic.h"

namespace physinv::test {
namespace {

constexpr Index kCount = 11;
const Rng kData = Rng::root("oracle_test", 1);

Oracle make(Needs needs = Needs::forward | Needs::vjp, Index n = kCount) {
  return Oracle(quadratic(), n, kData, needs);
}

TEST(Oracle, EvaluatesLossAndGradientOfItsProblems) {
  Oracle oracle = make();
  const Batch<double> x = oracle.data().x.array() + 0.1;
  Vector<double> loss(kCount), alone(kCount), measured(kCount);
  Batch<double> gradient(2, kCount);
  oracle.evaluate<double>(oracle.all(), x, loss, gradient);
  oracle.evaluate<double>(oracle.all(), x, alone);
  oracle.measure(x, measured);
  EXPECT_TRUE(same_bits(loss, alone));
  EXPECT_TRUE(same_bits(loss, measured));
  // r = A 0.1 for everybody.
  const Eigen::Matrix2d a = Quadratic<double>::matrix();
  const Eigen::Vector2d r = a * Eigen::Vector2d(0.1, 0.1);
  EXPECT_LE((loss.array() - 0.5 * r.squaredNorm()).abs().maxCoeff(), 1e-15);
  EXPECT_LE((gradient.colwise() - a.transpose() * r).cwiseAbs().maxCoeff(),
            1e-14);
}

/// Wants gradients of four samples at a time, and notes how many it was given.
template <class T>
class InBlocks final : public GradientQuadratic<T> {
 public:
  using GradientQuadratic<T>::GradientQuadratic;
  static inline std::vector<Index> given_;

  Index gradient_block() const override { return 4; }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto& x = at.x;
    given_.push_back(x.cols());
    GradientQuadratic<T>::linearize(at, y, tape);
  }
};

/// A block for each: one block for all would be the work of one thread.
TEST(Oracle, GivesEveryThreadABlockOfGradients) {
  const auto gradients = [](int count) {
    Threads threads(count);
    Oracle oracle(problem<InBlocks>("blocks"),
                  kCount,
                  kData,
                  Needs::forward | Needs::vjp,
                  &threads);
    const Batch<double> x = oracle.data().x.array() + 0.1;
    Vector<double> loss(kCount);
    Batch<double> gradient(2, kCount);
    InBlocks<double>::given_.clear();
    oracle.evaluate<double>(oracle.all(), x, loss, gradient);
    return gradient;
  };
  const Batch<double> one = gradients(1);
  EXPECT_EQ(InBlocks<double>::given_, (std::vector<Index>{4, 4, 3}));
  const Batch<double> two = gradients(2);
  EXPECT_EQ(InBlocks<double>::given_, (std::vector<Index>{8, 3}));
  EXPECT_TRUE(same_bits(one, two));
}

template <class T>
void expect_subsets() {
  Oracle oracle = make();
  const Batch<T> x = oracle.start().template cast<T>();
  Vector<double> loss(kCount);
  Batch<T> gradient(2, kCount);
  oracle.evaluate<T>(oracle.all(), x, loss, gradient);
  std::vector<Index> reversed(kCount);
  for (Index i = 0; i < kCount; ++i)
    reversed[static_cast<std::size_t>(i)] = kCount - 1 - i;
  const std::vector<std::vector<Index>> subsets = {
      {0}, {10}, {3, 4, 9}, {9, 2}, {5, 5}, reversed};
  for (const auto& some : subsets) {
    const auto m = static_cast<Index>(some.size());
    Vector<double> l(m), alone(m);
    Batch<T> g(2, m);
    oracle.evaluate<T>(some, x.leftCols(m), l, g);
    oracle.evaluate<T>(some, x.leftCols(m), alone);
    EXPECT_TRUE(same_bits(l, Vector<double>(loss(some))));
    EXPECT_TRUE(same_bits(alone, l));
    EXPECT_TRUE(same_bits(g, Batch<T>(gradient(Eigen::all, some))));
  }
}

TEST(Oracle, ActiveSubsetsEqualTheFullSetBitwise) {
  expect_subsets<float>();
  expect_subsets<double>();
}

TEST(Oracle, CountsWhatIsAskedAndNothingElse) {
  Oracle oracle = make();
  Vector<double> loss(kCount);
  Batch<double> gradient(2, kCount);
  const Batch<double> x = oracle.start();
  const std::vector<Index> some = {2, 5};
  oracle.measure(x, loss);
  EXPECT_EQ(oracle.counts(), Counts{});
  oracle.evaluate<double>(oracle.all(), x, loss);
  oracle.evaluate<double>(some, x.leftCols(2), loss.head(2));
  oracle.evaluate<float>(some, x.leftCols(2).cast<float>(), loss.head(2));
  oracle.evaluate<double>(
      some, x.leftCols(2), loss.head(2), gradient.leftCols(2));
  oracle.add(Counter::network_forward, 3);
  Counts more;
  more[Counter::skipped_rows] = 4;
  oracle.add(more);
  Counts expected = more;
  expected[Counter::forward] = kCount + 4;
  expected[Counter::vjp] = 2;
  expected[Counter::network_forward] = 3;
  EXPECT_EQ(oracle.counts(), expected);
  EXPECT_EQ(oracle.counts(), expected) << "asking twice adds nothing";
}

TEST(Oracle, RefusesWhatWasNotDeclared) {
  Oracle oracle = make(Needs::forward);
  Vector<double> loss(kCount);
  Batch<double> gradient(2, kCount);
  EXPECT_THROW(oracle.labelled(), ContractError);
  EXPECT_THROW(
      oracle.evaluate<double>(oracle.all(), oracle.start(), loss, gradient),
      ContractError);
  EXPECT_NO_THROW(oracle.evaluate<double>(oracle.all(), oracle.start(), loss));
}

TEST(Oracle, HandsOutItsProblemCounted) {
  Oracle oracle = make();
  auto problem = oracle.problem<double>();
  const Batch<double> x = oracle.start();
  Batch<double> y(2, kCount), y_bar(2, kCount), gradient(2, kCount);
  Vector<double> loss(kCount), expected_loss(kCount);
  problem.linearize(x, oracle.given(), y);
  problem.loss(y, oracle.observations(), loss);
  problem.loss_gradient(y, oracle.observations(), y_bar);
  EXPECT_EQ(problem.counts(), Counts{});
  problem.pullback(y_bar, gradient);
  problem.forward(x.leftCols(3), oracle.given().leftCols(3), y.leftCols(3));
  Counts made;
  made[Counter::vjp] = kCount;
  made[Counter::forward] = 3;
  EXPECT_EQ(problem.counts(), made);
  EXPECT_EQ(oracle.counts(), Counts{}) << "until they are given back";
  oracle.add(problem.counts());
  EXPECT_EQ(oracle.counts(), made);
  Batch<double> expected(2, kCount);
  oracle.evaluate<double>(oracle.all(), x, expected_loss, expected);
  EXPECT_TRUE(same_bits(loss, expected_loss));
  EXPECT_TRUE(same_bits(gradient, expected));
  // What the problem lacks, and what was not declared.
  EXPECT_THROW(problem.invert(y, oracle.given(), x, gradient), ContractError);
  auto forward_only = make(Needs::forward).problem<double>();
  EXPECT_THROW(forward_only.linearize(x, oracle.given(), y), ContractError);
}

TEST(Oracle, SiblingsHaveOtherProblemsAndTheirOwnCounts) {
  Oracle oracle = make();
  Oracle other = oracle.sibling(4, kData.child("other"), Needs::forward);
  EXPECT_EQ(other.count(), 4);
  EXPECT_FALSE(same_bits(other.observations(),
                         Batch<double>(oracle.observations().leftCols(4))));
  Vector<double> loss(4);
  other.evaluate<double>(other.all(), other.start(), loss);
  EXPECT_EQ(other.counts()[Counter::forward], 4U);
  EXPECT_EQ(oracle.counts(), Counts{});
}

TEST(Oracle, RefusesWrongShapes) {
  Oracle oracle = make();
  Vector<double> loss(kCount);
  Batch<double> gradient(2, kCount), tall(3, kCount);
  const Batch<double> x = oracle.start();
  const auto all = oracle.all();
  EXPECT_THROW(oracle.evaluate<double>(all, tall, loss), ContractError);
  EXPECT_THROW(oracle.evaluate<double>(all, x.leftCols(2), loss),
               ContractError);
  EXPECT_THROW(oracle.evaluate<double>(all, x, loss.head(2)), ContractError);
  EXPECT_THROW(oracle.evaluate<double>(all, x, loss, tall), ContractError);
  EXPECT_THROW(oracle.evaluate<double>(all, x, loss, gradient.leftCols(2)),
               ContractError);
  EXPECT_THROW(make(Needs::forward, 0), ContractError);
}

TEST(Oracle, LabelsAreASeparateSetOfPrefixes) {
  const Needs needs = Needs::forward | Needs::labels;
  Oracle small = make(needs, 4), large = make(needs);
  EXPECT_EQ(large.labelled().count(), kCount);
  const auto& few = small.labelled();
  EXPECT_TRUE(same_bits(few.x, Batch<double>(large.labelled().x.leftCols(4))));
  EXPECT_TRUE(
      same_bits(small.data().x, Batch<double>(large.data().x.leftCols(4))));
  for (Index i = 0; i < 4; ++i)
    for (Index j = 0; j < kCount; ++j)
      EXPECT_NE(few.x(0, i), large.data().x(0, j));
  EXPECT_EQ(large.counts(), Counts{});
  EXPECT_EQ(&large.labelled(), &large.labelled());
}

TEST(Oracle, TakesNoMoreMemoryTheSecondTime) {
  Oracle oracle = make();
  Vector<double> loss(kCount);
  Batch<double> gradient(2, kCount);
  const std::vector<Index> some = {2, 5};
  const Batch<double> x = oracle.start();
  const auto use = [&] {
    oracle.evaluate<double>(oracle.all(), x, loss, gradient);
    oracle.evaluate<double>(some, x.leftCols(2), loss.head(2));
  };
  use();
  const std::size_t bytes = oracle.bytes();
  EXPECT_GT(bytes, 0U);
  for (int i = 0; i < 3; ++i) use();
  EXPECT_EQ(oracle.bytes(), bytes);
}

}  // namespace
}  // namespace physinv::test
