// The updates of hig-quantum-dipole: dense and convolutional networks, and a
// control without one.
#include <gtest/gtest.h>

#include <stdexcept>

#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/core/any_problem.h"
#include "tests/optimizers/hig_learner.h"

namespace physinv::test {
namespace {

/// In float the rows of the network, rounded, and the states after 384 steps
/// leave more of an inverse power than elsewhere.
Learner quantum(const std::string& network) {
  if (network != "fc" && network != "cnn")
    throw std::runtime_error("no test has the network " + network);
  return {
      .problem = problems::quantum_dipole().make<double>(),
      .single = problems::quantum_dipole().make<float>(),
      .network =
          network == "fc"
              ? Ordered({28, 20, 20, 20, 384}, nn::Activation::tanh)
              : Ordered(nn::CnnOptions{.positions = 14,
                                       .channels = 2,
                                       .features = std::vector<Index>(6, 20)},
                        384),
      .factor = [](Index b) { return 1.0 / static_cast<double>(b); },
      .in_float = 1e-3};
}

void check_quantum_batch(const Json& entry) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const Learner l = quantum(in.at("network"));
  check_batch(l, "target", entry);

  const Batch<double> target = flat_columns(in.at("target"));
  At at(l, l.network.start(in), target);
  EXPECT_EQ(at.theta.size(), out.at("parameters").get<Index>());
  const Vector<double> first = flat(out.at("control_first_every16"));
  ASSERT_LE(16 * first.size(), at.x.rows() + 15);
  EXPECT_TRUE(
      same(at.x.col(0)(Eigen::seqN(0, first.size(), 16)).eval(), first));
  EXPECT_TRUE(same(at.x.colwise().norm().transpose().eval(),
                   flat(out.at("control_norm"))));
  EXPECT_TRUE(same(at.loss, flat(out.at("loss_each"))));
  // Before the projection.
  EXPECT_TRUE(same(at.mean_gradient.reshaped(), flat(out.at("g"))));
  Vector<double> level(target.cols());
  quantum_level_loss<double>(2, at.y, target, level);
  EXPECT_TRUE(same(level.mean(), number(out.at("low_energy_loss"))));
  quantum_level_loss<double>(3, at.y, target, level);
  EXPECT_TRUE(same(level.mean(), number(out.at("high_energy_loss"))));
}

/// A control without a network: the update is written out, from the power of
/// the solver's Jacobian.
void check_direct(const Json& entry) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  Batch<double> x = flat(in.at("u0"));
  const AnyProblem<double> box(problems::quantum_dipole({.steps = x.rows()}));
  const Index m = box.shape().observations;
  const Batch<double> target = flat(in.at("target"), m);
  Batch<double> y(m, 1), g(m, 1), s(m * x.rows(), 1);
  Vector<double> loss(1), update(x.rows());
  const Batch<double> given(0, 1);
  Workspace work;
  const Vector<double> losses = flat(out.at("losses"));
  const Index updates = in.at("updates");
  ASSERT_EQ(losses.size(), updates + 1);
  hig::ExplicitPower power;
  for (Index k = 0; k <= updates; ++k) {
    box.forward(x, given, y, work);
    box.loss(y, target, loss);
    EXPECT_TRUE(same(loss(0), losses(k))) << "update " << k;
    if (k == updates) break;
    box.loss_gradient(y, target, g);
    box.project(y, g);
    box.jacobian(x, given, s, work);
    power.factor(s.reshaped(m, x.rows()), g.col(0));
    power.apply({.kappa = in.at("kappa"), .tau = in.at("tau")}, update);
    x.col(0) -= in.at("eta").get<double>() * update;
  }
  EXPECT_TRUE(same(x.col(0), flat(out.at("u_final"))));
}

// The solver's own entries: tests/problems/quantum_dipole_reference_test.cpp.
TEST(HigReference, QuantumDipole) {
  check_entries("hig-quantum-dipole",
                {{"pure_*", check_direct},
                 {"fc_*", check_quantum_batch},
                 {"cnn_*", check_quantum_batch}},
                {"eigenstates", "solver_*"});
}

}  // namespace
}  // namespace physinv::test
