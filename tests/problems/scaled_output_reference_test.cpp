// The forward entries of hig-toy: a tiny network, differentiated by hand,
// before the problem's own derivatives.

#include "problems/scaled_output/scaled_output.h"
#include "suite/core/any_problem.h"
#include "tests/problems/physics_checks.h"
#include "tests/support/hig_reference.h"
#include "tests/support/singular_values.h"

namespace physinv::test {
namespace {

const std::string kId = "hig-toy";

/// The network 1-7-2 at one point, and d y / d theta (2 x 30).
struct Network {
  Network(const Vector<double>& theta, double t)
      : hidden(7), y(2), slope(Batch<double>::Zero(2, 30)) {
    y = theta.tail(2);
    for (Index k = 0; k < 7; ++k) {
      hidden(k) = std::tanh(theta(k) * t + theta(7 + k));
      const double d = 1 - hidden(k) * hidden(k);
      for (Index c = 0; c < 2; ++c) {
        const double w = theta(14 + 2 * k + c);
        y(c) += hidden(k) * w;
        slope(c, k) = w * d * t;
        slope(c, 7 + k) = w * d;
        slope(c, 14 + 2 * k + c) = hidden(k);
        slope(c, 28 + c) = 1;
      }
    }
  }
  Vector<double> hidden, y;
  Batch<double> slope;
};

void check_forward(const Json& entry) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const Vector<double> theta = flat(in.at("theta"), 30),
                       points = flat(in.at("x"));
  const Index n = points.size();
  const AnyProblem<double> fit(
      problems::scaled_output({.gamma = number(in.at("gamma"))}));
  Physics at(fit);
  Batch<double> y(2, n), target(2, n), hidden(7, n), stacked(2 * n, 30);
  std::vector<Network> nets;
  for (Index i = 0; i < n; ++i) {
    nets.emplace_back(theta, points(i));
    hidden.col(i) = nets.back().hidden, y.col(i) = nets.back().y;
    target.col(i) << std::sin(6 * points(i)), std::cos(9 * points(i));
  }
  const Batch<double> given = points.transpose();
  const Batch<double> z = at.linearize(y, given);
  EXPECT_TRUE(same(hidden, flat(out.at("hidden"))));
  EXPECT_TRUE(same(y, flat(out.at("y"))));
  EXPECT_TRUE(same(z, flat(out.at("z"))));
  Vector<double> loss(n), gradient = Vector<double>::Zero(30);
  Batch<double> z_bar(2, n);
  fit.loss(z, target, loss);
  fit.loss_gradient(z, target, z_bar);
  EXPECT_TRUE(same(loss.mean(), number(out.at("loss"))));
  const Batch<double> y_bar = at.pullback(z_bar), j = at.jacobian(y, given);
  for (Index i = 0; i < n; ++i) {
    const Batch<double>& slope = nets[std::size_t(i)].slope;
    gradient += slope.transpose() * y_bar.col(i) / double(n);
    stacked.middleRows(2 * i, 2) = at.matrix(j, i) * slope;
  }
  EXPECT_TRUE(same(gradient, flat(out.at("grad"))));
  EXPECT_TRUE(same(stacked, rows(out.at("jacobian"))));
  EXPECT_TRUE(Comparator(1e-12, 0)(jacobi_singular_values(stacked).s,
                                   flat(out.at("singular_values"))));
}

// The updates: tests/optimizers/hig_toy_reference_test.cpp.
TEST(ScaledOutputReference, ForwardEntries) {
  check_entries(
      kId, {{"forward_*", check_forward}}, {"updates_*", "trajectory_*"});
}

}  // namespace
}  // namespace physinv::test
