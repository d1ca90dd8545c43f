// The updates of hig-quantum-dipole: dense and convolutional networks, and a
// control without one.
#include <gtest/gtest.h>

#include <set>

#include "problems/quantum_dipole/quantum_dipole.h"
#include "tests/optimizers/hig_learner.h"

namespace physinv::test {
namespace {

/// In float 384 steps leave 1e-6 of the Jacobian, which an inverse power
/// multiplies: updates are good to 3e-3, not to 1e-4.
Learner quantum(const std::string& network) {
  return {
      .problem = std::make_unique<QuantumDipole<double>>(),
      .single = std::make_unique<QuantumDipole<float>>(),
      .network =
          network == "fc"
              ? Ordered({28, 20, 20, 20, 384}, nn::Activation::tanh)
              : Ordered(nn::CnnOptions{.positions = 14,
                                       .channels = 2,
                                       .features = std::vector<Index>(6, 20)},
                        384),
      .factor = [](Index b) { return 1.0 / static_cast<double>(b); },
      .in_float = 3e-3};
}

void check_quantum_batch(const Json& entry) {
  const Json& in = entry.at("input");
  Expected out(entry);
  const auto same = HigTolerance(entry).array();
  const Learner l = quantum(in.at("network"));
  check_batch(l, "target", entry, out);

  const Batch<double> target = flat_columns(in.at("target"));
  At at(l, l.network.start(in), target);
  EXPECT_EQ(at.theta.size(), out.at("parameters").get<Index>());
  EXPECT_TRUE(same(at.x.col(0)(Eigen::seqN(0, 24, 16)).eval(),
                   flat(out.at("control_first_every16"))));
  EXPECT_TRUE(same(at.x.colwise().norm().transpose().eval(),
                   flat(out.at("control_norm"))));
  EXPECT_TRUE(same(at.loss, flat(out.at("loss_each"))));
  // Before the projection.
  EXPECT_TRUE(same(at.mean_gradient.reshaped(), flat(out.at("g"))));
  const QuantumDipole<double> box;
  Vector<double> level(target.cols());
  box.level_loss(2, at.y, target, level);
  EXPECT_TRUE(same(level.mean(), out.at("low_energy_loss")));
  box.level_loss(3, at.y, target, level);
  EXPECT_TRUE(same(level.mean(), out.at("high_energy_loss")));
}

/// A control without a network: the update is written out, from the power of
/// the solver's Jacobian.
void check_direct(const Json& entry) {
  const Json& in = entry.at("input");
  Expected out(entry);
  const auto same = HigTolerance(entry).array();
  const Batch<double> target = flat(in.at("target"));
  const QuantumDipole<double> box;
  Batch<double> x = flat(in.at("u0")), y(28, 1), g(28, 1), s(28 * 384, 1);
  Vector<double> loss(1), update(384);
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
    power.factor(s.reshaped(28, 384), g.col(0));
    power.apply({.kappa = in.at("kappa"), .tau = in.at("tau")}, update);
    x.col(0) -= in.at("eta").get<double>() * update;
  }
  EXPECT_TRUE(same(x.col(0), flat(out.at("u_final"))));
}

// The solver's own entries: tests/problems/quantum_dipole_reference_test.cpp.
TEST(HigReference, QuantumDipole) {
  const std::set<std::string> solver = {
      "eigenstates", "solver_random", "solver_zero"};
  int batches = 0, direct = 0;
  const Json file = load_reference("hig-quantum-dipole");
  for (const Json& e : file.at("entries")) {
    const std::string name = e.at("name");
    SCOPED_TRACE(name);
    if (solver.contains(name)) continue;
    if (name == "pure_hig") {
      check_direct(e), ++direct;
    } else {
      ASSERT_TRUE(name.starts_with("fc_") || name.starts_with("cnn_"))
          << "no test reads this entry";
      check_quantum_batch(e), ++batches;
    }
  }
  EXPECT_GE(batches, 3);
  EXPECT_GE(direct, 1);
}

}  // namespace
}  // namespace physinv::test
