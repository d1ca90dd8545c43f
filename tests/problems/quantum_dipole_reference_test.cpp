// The solver entries of hig-quantum-dipole.

#include <functional>
#include <map>

#include "problems/quantum_dipole/quantum_dipole.h"
#include "tests/problems/physics_checks.h"
#include "tests/support/hig_reference.h"
#include "tests/support/singular_values.h"

namespace physinv::test {
namespace {

const std::string kId = "hig-quantum-dipole";

/// Entries of the networks and of the updates.
const std::set<std::string> kTraining = {
    "pure_hig", "fc_batch2", "fc_batch6", "cnn_batch2"};

void check_eigenstates(const Json& entry) {
  const auto same = HigTolerance(entry).array();
  const Json& out = entry.at("expected");
  Vector<double> energies(3);
  for (int k = 1; k <= 3; ++k) {
    energies(k - 1) = quantum_energy(k);
    EXPECT_TRUE(
        same(quantum_eigenstate(k), flat(out.at("psi" + std::to_string(k)))));
  }
  EXPECT_TRUE(same(energies, flat(out.at("energies"))));
}

template <class T>
void check_jacobian(const Batch<double>& s,
                    const Json& out,
                    const TwoNorm& same) {
  EXPECT_TRUE(same(s.norm(), number(out.at("S_frobenius"))));
  EXPECT_TRUE(same(s * hig_probe(384, 900000), flat(out.at("S_probe"))));
  const Json& stored = out.at("S_columns");
  for (std::size_t i = 0; i < stored.at("index").size(); ++i)
    EXPECT_TRUE(same(s.col(stored.at("index")[i].get<Index>()),
                     flat(stored.at("values")[i])));
  const Vector<double> sigma = jacobi_singular_values(s).s;
  const Vector<double> expected = flat(out.at("S_singular_values"));
  const double near = std::is_same_v<T, double> ? 1e-12 : 1e-5;
  EXPECT_TRUE(Comparator(near, 0)(sigma, expected));
}

template <class T>
void check_solver(const Json& entry, const TwoNorm& same) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const Batch<T> x = flat(in.at("u")).cast<T>(), given(0, 1);
  const Batch<T> target = flat(in.at("target")).cast<T>();
  const QuantumDipole<T> box;
  Physics<QuantumDipole<T>, T> at(box);
  const Batch<T> y = at.linearize(x, given);
  EXPECT_TRUE(same(y, flat(out.at("psi"))));
  EXPECT_TRUE(same(double(y.squaredNorm()), number(out.at("norm2"))));
  for (const Index steps : {1, 2, 192}) {
    const QuantumDipole<T> part({.steps = steps});
    EXPECT_TRUE(same(
        (Physics<QuantumDipole<T>, T>(part).forward(x.topRows(steps), given)),
        flat(out.at("after_" + std::to_string(steps)))));
  }
  Vector<double> loss(1);
  Batch<T> y_bar(28, 1);
  for (const bool accurate : {false, true}) {
    const QuantumDipole<T> p({.accurate_loss = accurate});
    p.loss(y, target, loss);
    EXPECT_TRUE(same(loss(0), number(out.at("loss"))));
    p.loss_gradient(y, target, y_bar);
    EXPECT_TRUE(same(at.pullback(y_bar), flat(out.at("dL_du"))));
  }
  if (out.contains("S_probe")) {
    const Batch<T> s = at.matrix(at.jacobian(x, given), 0);
    check_jacobian<T>(s.template cast<double>(), out, same);
  }
}

void check_solver_both(const Json& entry) {
  check_solver<double>(entry, HigTolerance(entry).array());
  // Without control every step repeats the rounding of the same factors.
  const bool still = flat(entry.at("input").at("u")).isZero();
  check_solver<float>(entry, {still ? 1e-4 : 3e-5, 1e-6});
}

TEST(QuantumDipoleReference, SolverEntries) {
  const std::map<std::string, EntryCheck> checks = {
      {"eigenstates", check_eigenstates},
      {"solver_random", check_solver_both},
      {"solver_zero", check_solver_both}};
  check_entries(kId, checks, kTraining);
}

}  // namespace
}  // namespace physinv::test
