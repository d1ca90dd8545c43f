// The solver entries of hig-quantum-dipole.

#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/core/any_problem.h"
#include "tests/problems/physics_checks.h"
#include "tests/support/hig_reference.h"
#include "tests/support/singular_values.h"

namespace physinv::test {
namespace {

const std::string kId = "hig-quantum-dipole";

void check_eigenstates(const Json& entry) {
  const auto same = HigTolerance(entry).array();
  const Json out = entry.at("expected");
  const Vector<double> energies = flat(out.at("energies"));
  EXPECT_TRUE(entry.at("input").empty()) << entry.at("input");
  for (int k = 1; k <= energies.size(); ++k) {
    EXPECT_TRUE(same(quantum_energy(k), energies(k - 1)));
    EXPECT_TRUE(
        same(quantum_eigenstate(k), flat(out.at("psi" + std::to_string(k)))));
  }
}

template <class T>
void check_jacobian(const Batch<double>& s,
                    const Json& out,
                    const TwoNorm& same) {
  EXPECT_TRUE(same(s.norm(), number(out.at("S_frobenius"))));
  EXPECT_TRUE(same(s * hig_probe(s.cols(), 900000), flat(out.at("S_probe"))));
  const Json stored = out.at("S_columns");
  const std::vector<Index> index = stored.at("index");
  for (std::size_t i = 0; i < index.size(); ++i) {
    ASSERT_TRUE(0 <= index[i] && index[i] < s.cols()) << index[i];
    EXPECT_TRUE(same(s.col(index[i]), flat(stored.at("values")[i])));
  }
  const Vector<double> sigma = jacobi_singular_values(s).s;
  const Vector<double> expected = flat(out.at("S_singular_values"));
  const double near = std::is_same_v<T, double> ? 1e-12 : 1e-5;
  EXPECT_TRUE(Comparator(near, 0)(sigma, expected));
}

template <class T>
void check_solver(const Json& entry, const TwoNorm& same) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const Batch<T> x = flat(in.at("u")).cast<T>(), given(0, 1);
  const Batch<T> target = flat(in.at("target"), 2 * kQuantumPoints).cast<T>();
  const AnyProblem<T> box(problems::quantum_dipole({.steps = x.rows()}));
  Physics at(box);
  const Batch<T> y = at.linearize(x, given);
  EXPECT_TRUE(same(y, flat(out.at("psi"))));
  EXPECT_TRUE(same(double(y.squaredNorm()), number(out.at("norm2"))));
  for (const auto& [steps, state] : states_after(out)) {
    ASSERT_TRUE(1 <= steps && steps <= x.rows()) << steps;
    const AnyProblem<T> part(problems::quantum_dipole({.steps = steps}));
    EXPECT_TRUE(same(Physics(part).forward(x.topRows(steps), given), state))
        << "after " << steps;
  }
  Vector<double> loss(1);
  Batch<T> y_bar(y);
  for (const bool accurate : {false, true}) {
    const AnyProblem<T> p(problems::quantum_dipole(
        {.steps = x.rows(), .accurate_loss = accurate}));
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

// The updates: tests/optimizers/hig_quantum_dipole_reference_test.cpp.
TEST(QuantumDipoleReference, SolverEntries) {
  check_entries(
      kId,
      {{"eigenstates", check_eigenstates}, {"solver_*", check_solver_both}},
      {"pure_*", "fc_*", "cnn_*"});
}

}  // namespace
}  // namespace physinv::test
