// The solver entries of hig-oscillators.

#include "problems/oscillators/oscillators.h"
#include "suite/core/any_problem.h"
#include "tests/problems/physics_checks.h"
#include "tests/support/hig_reference.h"

namespace physinv::test {
namespace {

const std::string kId = "hig-oscillators";

template <class T>
void check_solver(const Json& entry, const TwoNorm& same) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const double g = number(in.at("g_cubic"));
  const Batch<T> x = flat(in.at("u")).cast<T>();
  const Batch<T> given = flat(in.at("x0"), 4).cast<T>();
  const AnyProblem<T> pair(
      problems::oscillators({.steps = x.rows(), .coupling = g}));
  Physics at(pair);
  const Batch<T> y = at.linearize(x, given);
  EXPECT_TRUE(same(y, flat(out.at("y"))));
  for (const auto& [steps, state] : states_after(out)) {
    ASSERT_TRUE(1 <= steps && steps <= x.rows()) << steps;
    const AnyProblem<T> part(
        problems::oscillators({.steps = steps, .coupling = g}));
    EXPECT_TRUE(same(Physics(part).forward(x.topRows(steps), given), state))
        << "after " << steps;
  }
  Vector<double> loss(1);
  Batch<T> y_bar(4, 1);
  pair.loss(y, given, loss);
  pair.loss_gradient(y, given, y_bar);
  EXPECT_TRUE(same(loss(0), number(out.at("loss"))));
  EXPECT_TRUE(same(at.pullback(y_bar), flat(out.at("dL_du"))));
  if (out.contains("S")) {
    EXPECT_TRUE(same(at.matrix(at.jacobian(x, given), 0), rows(out.at("S"))));
  }
}

void check_solver_both(const Json& entry) {
  check_solver<double>(entry, HigTolerance(entry).array());
  check_solver<float>(entry, {2e-5, 1e-6});
}

template <class T>
void check_step(const Json& entry, const TwoNorm& same) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const Vector<double> x0 = flat(in.at("x0"), 4);
  const auto step = oscillators_step<T>({x0(0), x0(1), x0(2), x0(3)},
                                        number(in.at("u")),
                                        {.coupling = number(in.at("g_cubic"))});
  const auto list = [](const std::array<double, 4>& v) {
    return Vector<double>(Eigen::Map<const Vector<double>>(v.data(), 4));
  };
  Batch<double> a(4, 4);
  for (Index r = 0; r < 4; ++r) a.row(r) = list(step.a[std::size_t(r)]);
  EXPECT_TRUE(same(a, rows(out.at("A"))));
  EXPECT_TRUE(same(list(step.b), flat(out.at("B"))));
  EXPECT_TRUE(same(list(step.y), flat(out.at("y"))));
}

void check_step_both(const Json& entry) {
  check_step<double>(entry, HigTolerance(entry).array());
  check_step<float>(entry, {1e-6, 1e-7});
}

// The updates: tests/optimizers/hig_oscillators_reference_test.cpp.
TEST(OscillatorsReference, SolverEntries) {
  check_entries(
      kId,
      {{"solver_*", check_solver_both}, {"one_step_tangent", check_step_both}},
      {"batch*", "sequence_*", "first_order_rules"});
}

}  // namespace
}  // namespace physinv::test
