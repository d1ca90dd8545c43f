// The step of a network and a solver whose Jacobian is far from 1.
#include "optimizers/half_inverse/half_inverse_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "suite/nn/mlp.h"
#include "tests/optimizers/half_inverse_truth.h"

namespace physinv {
namespace {

/// The update at random weights, the solver's Jacobians times `size`.
template <class T>
Vector<double> update(const HalfInverseStepOptions& options,
                      Index samples,
                      double size,
                      hig::HalfInverseReport& report,
                      Counts* counts = nullptr) {
  constexpr Index kIn = 2, kOut = 3, kSeen = 2;
  const auto net = nn::mlp({.hidden = {4}, .activation = nn::Activation::tanh})
                       .make<T>(kIn, kOut);
  Vector<T> parameters(net->parameter_count()), state;
  net->initialize(Rng::root("half_inverse_step_test", 1), parameters, state);
  const Batch<T> in = hig::noise(kIn, samples, 5).template cast<T>();
  const Batch<T> g = hig::noise(kSeen, samples, 6).template cast<T>();
  const Batch<T> solver =
      (size * hig::noise(kSeen * kOut, samples, 7)).template cast<T>();
  Batch<T> out(kOut, samples);
  Tape tape;
  Workspace work;
  net->forward(parameters, state, in, out, tape, work, {.training = true});
  HalfInverseStep<T> step(options);
  step(*net, parameters, tape, solver, g, work);
  report = step.report();
  if (counts != nullptr) *counts = work.counts;
  return step.update();
}

template <class T>
void expect_scaled(const hig::Power& power,
                   Index samples,
                   double size,
                   double near) {
  SCOPED_TRACE(testing::Message()
               << power.kappa << ", " << samples << " samples, " << size);
  hig::HalfInverseReport here, there;
  const HalfInverseStepOptions options{.power = power};
  const Vector<double> one = update<T>(options, samples, 1, here);
  const Vector<double> far = update<T>(options, samples, size, there);
  ASSERT_GT(one.norm(), 0);
  const double factor = std::pow(size, power.kappa + power.beta);
  EXPECT_EQ(there.ending, hig::Ending::ok);
  EXPECT_EQ(there.path, here.path);
  EXPECT_EQ(there.kept, here.kept);
  EXPECT_LE((far / factor - one).norm(), near * one.norm());
  EXPECT_NEAR(there.s_max / size, here.s_max, near * here.s_max);
}

// 27 parameters: few rows are solved by J J^T, many by J itself.
TEST(HalfInverseStep, JacobiansAtExtremesOfScale) {
  for (const hig::Power power : {hig::Power{.kappa = -0.5, .tau = 1e-4},
                                 hig::Power{.kappa = -1, .tau = 1e-4},
                                 hig::Power{.kappa = 0.5, .tau = 1e-4}})
    for (const Index samples : {3, 40}) {
      for (const double size : {1e-250, 1e-200, 1e-100, 1e100, 1e200, 1e250})
        expect_scaled<double>(power, samples, size, 1e-9);
      for (const double size : {1e-30, 1e-20, 1e20, 1e30})
        expect_scaled<float>(power, samples, size, 1e-3);
    }
}

TEST(HalfInverseStep, CountsLevelsOfEitherWay) {
  for (const Index samples : {3, 40})
    for (const double tolerance : {3e-4, 1e-30}) {
      hig::HalfInverseReport report;
      Counts counts;
      update<double>({.power = {.kappa = -0.5, .tau = 1e-4},
                      .numerics = {.tolerance = tolerance}},
                     samples,
                     1,
                     report,
                     &counts);
      // J itself is taken apart without a proof, and at once.
      const bool spared = samples == 40 || tolerance > 1e-20;
      EXPECT_EQ(counts[Counter::skipped_levels], spared ? 1U : 0U);
      if (spared) {
        EXPECT_EQ(counts[Counter::abandoned_levels], 0U);
      } else {
        EXPECT_GE(counts[Counter::abandoned_levels], 2U);
      }
    }
}

}  // namespace
}  // namespace physinv
