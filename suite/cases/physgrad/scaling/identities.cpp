#include <cmath>

#include "problems/scaling/scaling.h"
#include "suite/cases/physgrad/scaling/scaling.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv::scaling {
namespace {

constexpr double kStep = 0.1;

/// A problem on a batch of its own.
struct Bench {
  explicit Bench(int power) : problem({.power = power}) {}

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

  Scaling<double> problem;
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
    return std::hypot(p(0, k), p(1, k));
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

class Identities final : public Diagnostic {
 public:
  std::string name() const override { return "identities"; }
  double operations(const CaseSize&) const override { return 1000; }

 protected:
  std::string kind() const override { return "identities"; }
  Options settings() const override { return {}; }
  void diagnose(StageRun& run, Outcome& out) const override {
    run.probe.begin();
    out.arrays = {{"order", order()}, {"linear", linear()}, {"roots", roots()}};
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
