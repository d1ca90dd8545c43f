#include "baselines/neural_adjoint.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "baselines/surrogate.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "tests/support/bits.h"
#include "tests/support/quadratic.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Index kCount = 15;

Outcome surrogate(Index iterations, Precision precision = Precision::f64) {
  const auto fit = surrogate_fit({.step = AdamOptions{.rate = 1e-2}});
  StageBench bench(*fit, kCount, iterations);
  return bench.run(nullptr, precision);
}

/// First terms of L~ at the start: 1/2 |N~(start, given_i) - y_i|^2.
Vector<double> surrogate_loss(const Outcome& fitted, StageBench& bench) {
  NetworkModel<double> model(
      bench.setting.surrogate, bench.oracle.shape(), 2, nullptr);
  model.load(fitted.arrays);
  const Batch<double> in = assemble<double>(bench.setting.surrogate.inputs,
                                            bench.oracle.start(),
                                            bench.oracle.given(),
                                            bench.oracle.observations());
  Batch<double> out(2, kCount);
  model.predict(in, out);
  return 0.5 * (out - bench.oracle.observations()).colwise().squaredNorm();
}

TEST(SurrogateFit, LearnsTheForwardProcessAndStaysAtTheStart) {
  for (const auto precision : {Precision::f32, Precision::f64}) {
    const Outcome first = surrogate(1, precision);
    const Outcome out = surrogate(500, precision);
    EXPECT_LT(out.arrays.at("training_loss")(0, 0),
              0.02 * first.arrays.at("training_loss")(0, 0));
    EXPECT_TRUE((out.x.colwise() - Eigen::Vector2d(0.5, -0.5)).isZero(0));
  }
}

TEST(NeuralAdjoint, IsNeverWorseThanTheStartAndKeepsTheBest) {
  const auto solve = neural_adjoint_solve();
  // Hardly trained surrogates mislead, trained ones lead.
  for (const Index trained : {1, 20, 500}) {
    const Outcome fitted = surrogate(trained);
    StageBench bench(*solve, kCount, 300);
    const Outcome out = bench.run(&fitted);
    const Vector<double> loss = bench.loss(out.x);
    const Vector<double> start = bench.loss(bench.oracle.start());
    EXPECT_TRUE((loss.array() <= start.array()).all());
    const Batch<double>& curve = bench.probe.curve().loss;
    EXPECT_TRUE(same_bits(Vector<double>(curve.col(0)), start));
    EXPECT_TRUE((loss.array() <= curve.rowwise().minCoeff().array()).all());
    if (trained == 500) {
      EXPECT_LT(loss.mean(), 0.1 * start.mean());
    }
  }
}

TEST(NeuralAdjoint, WeighsTheBoundaryByTenMedians) {
  const auto solve = neural_adjoint_solve();
  const Outcome fitted = surrogate(50);
  StageBench bench(*solve, kCount, 5);
  const Outcome out = bench.run(&fitted);
  Vector<double> loss = surrogate_loss(fitted, bench);
  std::sort(loss.begin(), loss.end());
  EXPECT_TRUE(Comparator(1e-12, 0)(out.arrays.at("boundary_weight")(0, 0),
                                   10 * loss(kCount / 2)));
  const auto light = neural_adjoint_solve({.weight = 1});
  StageBench other(*light, kCount, 5);
  EXPECT_TRUE(Comparator(1e-12, 0)(
      other.run(&fitted).arrays.at("boundary_weight")(0, 0), loss(kCount / 2)));
}

// The wall holds the estimates near the training data; without one a badly
// trained surrogate leads far away.
TEST(NeuralAdjoint, TheBoundaryBinds) {
  const Outcome fitted = surrogate(20);
  const auto farthest = [&](double weight) {
    const auto solve = neural_adjoint_solve({.weight = weight});
    StageBench bench(*solve, kCount, 300);
    bench.run(&fitted);
    return bench.probe.curve().x.cwiseAbs().maxCoeff();
  };
  EXPECT_LT(farthest(10), 1.6);
  EXPECT_GT(farthest(1e-9), farthest(10));
}

TEST(NeuralAdjoint, SimulatesAcceptedIteratesOnly) {
  const auto solve = neural_adjoint_solve();
  const Outcome fitted = surrogate(200);
  StageBench bench(*solve, kCount, 300);
  const Outcome out = bench.run(&fitted);
  const Counts& counts = bench.oracle.counts();
  EXPECT_EQ(counts[Counter::vjp], 0U);
  EXPECT_EQ(counts[Counter::forward],
            static_cast<std::uint64_t>(out.iterations.sum()) + kCount);
  EXPECT_GT(counts[Counter::network_backward], 0U);
}

TEST(NeuralAdjoint, ReadsUnknownsWhereverTheyStand) {
  Setting swapped = quadratic_setting();
  std::swap(swapped.surrogate.inputs[0], swapped.surrogate.inputs[1]);
  const auto fit = surrogate_fit({.step = AdamOptions{.rate = 1e-2}});
  const auto solve = neural_adjoint_solve();
  StageBench first(*fit, kCount, 500, quadratic(), swapped);
  const Outcome fitted = first.run();
  StageBench bench(*solve, kCount, 300, quadratic(), swapped);
  const Outcome out = bench.run(&fitted);
  EXPECT_LT(bench.loss(out.x).mean(),
            0.1 * bench.loss(bench.oracle.start()).mean());
}

}  // namespace
}  // namespace physinv::test
