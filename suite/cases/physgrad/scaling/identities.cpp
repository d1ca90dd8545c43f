#include <cmath>

#include "problems/oscillators/oscillators.h"
#include "problems/scaling/scaling.h"
#include "suite/cases/physgrad/scaling/scaling.h"
#include "suite/core/any_problem.h"
#include "suite/core/math.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv::scaling {
namespace {

constexpr double kStep = 0.1;

/// A problem on its own batch.
struct Bench {
  explicit Bench(int power) : problem(problems::scaling({.power = power})) {}

  Batch<double> forward(const Batch<double>& x, const Batch<double>& alpha) {
    Batch<double> y(2, x.cols());
    problem.forward(x, alpha, y, work);
    return y;
  }
  Batch<double> invert(const Batch<double>& y, const Batch<double>& guess) {
    Batch<double> x(2, y.cols());
    problem.invert(y, Batch<double>::Ones(1, y.cols()), guess, x, work);
    return x;
  }

  AnyProblem<double> problem;
  Workspace work;
};

Batch<double> order() {
  Bench b(2);
  const Batch<double> x = Batch<double>::Constant(2, 6, 3);
  const Batch<double> alpha = Batch<double>::Ones(1, 6);
  const Batch<double> y = b.forward(x, alpha);
  Batch<double> dy(2, 6), ig(2, 6), found(3, 6);
  b.problem.inverse_gradient_step(x, alpha, Batch<double>::Zero(2, 6), ig);
  for (Index k = 0; k < 6; ++k) {
    const double rate = std::ldexp(kStep, -static_cast<int>(k));
    dy.col(k) = -rate * y.col(k);
    ig.col(k) *= rate;
  }
  const Batch<double> pg = b.invert(y + dy, x), end = x + ig;
  const Batch<double> reached = b.forward(pg, alpha), wanted = y + dy;
  const auto distance = [](const Batch<double>& p, Index k) {
    return math::hypot(p(0, k), p(1, k));
  };
  for (Index k = 0; k < 6; ++k)
    found.col(k) << distance(dy, k), distance(pg - end, k),
        distance(reached - wanted, k);
  return found;
}

/// L is the second observation.
Batch<double> linear() {
  Bench b(1);
  const Eigen::RowVector3d alpha(0.01, 1, 250);
  const Batch<double> zero = Batch<double>::Zero(2, 3);
  Batch<double> one = zero, goal = zero, y = zero, gradient = zero, ig = zero;
  one.row(1).setOnes(), goal.row(1).setConstant(-kStep);
  Tape tape;
  b.problem.linearize(zero, alpha, y, tape);
  b.problem.pullback(tape, one, gradient, b.work);
  b.problem.inverse_gradient_step(zero, alpha, goal, ig);
  Batch<double> found(3, 3);
  found << alpha, b.forward(-kStep * gradient, alpha).row(1),
      b.forward(ig, alpha).row(1);
  return found;
}

Batch<double> roots() {
  Bench b(2);
  Batch<double> found(3, 6);
  found.row(0) << 2.25, 2.25, 9, 9, 2, 2;
  found.row(1) << -0.3, 0.3, -3, 3, -0.01, 3;
  found.row(2) =
      b.invert(found.row(0).replicate(2, 1), found.row(1).replicate(2, 1))
          .row(1);
  return found;
}

/// d y2 that a step makes to first order, over the one that was asked for.
Batch<double> inner() {
  Batch<double> found(3, 6);
  for (const int power : {1, 2}) {
    Bench b(power);
    const Index first = 3 * (power - 1);
    Batch<double> x = Batch<double>::Ones(2, 3), alpha(1, 3);
    alpha << 0.01, 1, 250;
    if (power == 2) x.row(1) << 0.5, 1, 3, alpha.setOnes();
    const Batch<double> zero = Batch<double>::Zero(2, 3);
    Batch<double> y = zero, slope = zero, y_bar = zero, gd = zero;
    Batch<double> unit = zero, ig = zero, newton = zero;
    unit.row(1).setOnes();
    Tape tape;
    b.problem.linearize(x, alpha, y, tape);
    b.problem.pullback(tape, unit, slope, b.work);
    b.problem.loss_gradient(y, zero, y_bar);
    b.problem.pullback(tape, y_bar, gd, b.work);
    b.problem.inverse_gradient_step(x, alpha, zero, ig);
    b.problem.newton_step(x, alpha, zero, newton);
    const auto relative = [&](const Batch<double>& dx) {
      return (-slope.row(1).array() * dx.row(1).array() / y.row(1).array())
          .matrix();
    };
    found.row(0).segment(first, 3) = relative(ig);
    found.row(1).segment(first, 3) = relative(newton);
    found.row(2).segment(first, 3) = relative(-gd);
  }
  return found;
}

/// From x2 = 3: dx2 / dy2 of the inverse simulator, and the mean of the local
/// gradient over the way in y by Simpson's rule.
Batch<double> average() {
  constexpr Index kParts = 2000;
  Bench b(2);
  Batch<double> found(3, 5);
  found.row(0) << 0.1, 0.3, 0.5, 0.7, 0.9;
  const Batch<double> ones = Batch<double>::Ones(1, kParts + 1);
  const Batch<double> guess = Batch<double>::Constant(2, kParts + 1, 3);
  const Batch<double> start = b.forward(guess, ones);
  for (Index k = 0; k < found.cols(); ++k) {
    Batch<double> y = start, ig(2, kParts + 1);
    for (Index i = 0; i <= kParts; ++i)
      y.col(i) *= 1 - found(0, k) * double(i) / double(kParts);
    const Batch<double> x = b.invert(y, guess);
    b.problem.inverse_gradient_step(
        x, ones, Batch<double>::Zero(2, kParts + 1), ig);
    double sum = 0;
    for (Index i = 0; i <= kParts; ++i) {
      const double weight = i == 0 || i == kParts ? 1 : i % 2 == 1 ? 4 : 2;
      sum -= weight * ig(1, i) / y(1, i);
    }
    found(1, k) = (x(1, kParts) - 3) / (y(1, kParts) - y(1, 0));
    found(2, k) = sum / double(3 * kParts);
  }
  return found;
}

/// x2 = 1 is moved by e and its observation inverted from 1 on.
Batch<double> local() {
  Bench b(2);
  Batch<double> found(2, 6), moved = Batch<double>::Ones(2, 6);
  found.row(0) << -3, -2, -1.5, -0.5, -0.1, -0.01;
  moved.row(1) += found.row(0);
  const Batch<double> y = b.forward(moved, Batch<double>::Ones(1, 6));
  const Batch<double> x = b.invert(y, Batch<double>::Ones(2, 6));
  found.row(1) = (x.row(1) - moved.row(1)).cwiseAbs();
  return found;
}

/// Where the Hessian is singular, x2 = 0, and next to it.
Batch<double> singular() {
  Bench b(2);
  Batch<double> x = Batch<double>::Ones(2, 3), h(4, 3), step(2, 3);
  x.row(1) << 0, 0.5, 3;
  const Batch<double> ones = Batch<double>::Ones(1, 3);
  const Batch<double> zero = Batch<double>::Zero(2, 3);
  b.problem.hessian(x, ones, zero, h, b.work);
  b.problem.newton_step(x, ones, zero, step);
  Batch<double> y = zero, y_bar = zero, gradient = zero, found(3, 3);
  Tape tape;
  b.problem.linearize(x, ones, y, tape);
  b.problem.loss_gradient(y, zero, y_bar);
  b.problem.pullback(tape, y_bar, gradient, b.work);
  for (Index i = 0; i < 3; ++i) {
    const double quotient = gradient(1, i) / h(3, i);
    found.col(i) << h(3, i), std::isfinite(quotient), step.col(i).allFinite();
  }
  return found;
}

/// Of x2, the share that a step takes: gradient descent, inverse gradients.
Batch<double> small() {
  Bench b(1);
  Batch<double> found(3, 3);
  found.row(0) << 1, 1e-2, 1e-3;
  const Batch<double> alpha = found.row(0), x = Batch<double>::Ones(2, 3);
  const Batch<double> zero = Batch<double>::Zero(2, 3);
  Batch<double> y = zero, y_bar = zero, gradient = zero, ig = zero;
  Tape tape;
  b.problem.linearize(x, alpha, y, tape);
  b.problem.loss_gradient(y, zero, y_bar);
  b.problem.pullback(tape, y_bar, gradient, b.work);
  b.problem.inverse_gradient_step(x, alpha, zero, ig);
  found.row(1) = kRate * gradient.row(1), found.row(2) = -kRate * ig.row(1);
  return found;
}

/// Two oscillators run to t = 12, then with velocities and controls turned
/// around: the distance from the start, for steps of 1/8, 1/16 and 1/32.
Batch<double> reversed() {
  Batch<double> found(2, 3);
  for (Index k = 0; k < 3; ++k) {
    const Index steps = 96 << k;
    const double dt = std::ldexp(0.125, -static_cast<int>(k));
    const AnyProblem<double> problem(
        problems::oscillators({.steps = steps, .dt = dt}));
    Batch<double> control(steps, 1), start(4, 1), end(4, 1), back(4, 1);
    for (Index i = 0; i < steps; ++i)
      control(i, 0) = 0.3 * math::cos(double(i >> k) / 8);
    start << 0.3, 0.8, 0.1, 0.5;
    Workspace work;
    problem.forward(control, start, end, work);
    end.bottomRows(2) *= -1;
    problem.forward(control.colwise().reverse(), end, back, work);
    back.bottomRows(2) *= -1;
    found.col(k) << dt, (back - start).norm();
  }
  return found;
}

class Identities final : public Diagnostic {
 public:
  std::string name() const override { return "identities"; }
  double operations(const CaseSize&) const override { return 1000; }

 protected:
  std::string kind() const override { return "identities"; }
  Options settings() const override { return {}; }
  void diagnose(StageRun& run, Outcome& out) const override {
    run.probe.begin();
    out.arrays = {{"order", order()},
                  {"linear", linear()},
                  {"roots", roots()},
                  {"inner", inner()},
                  {"average", average()},
                  {"local", local()},
                  {"singular", singular()},
                  {"small", small()},
                  {"reversed", reversed()}};
    const Index n = run.oracle.count();
    out.status.assign(static_cast<std::size_t>(n), Status::gtol);
    out.iterations.setZero(n), out.evaluations.setZero(n);
  }
};

}  // namespace

std::shared_ptr<const Stage> identities() {
  return std::make_shared<Identities>();
}

}  // namespace physinv::scaling
