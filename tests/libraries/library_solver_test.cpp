// Libraries made up here, on half the squared distance from (3, 3). Whatever a
// library does is a result.
#include "library_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "optimizers/drive.h"

namespace libraries {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr Index kBudget = 50;
const Task kTask{.iterations = 10, .evaluations = kBudget};

/// Two unknowns; `wall`: NaN where the first is above it.
struct Bowl {
  double wall = std::numeric_limits<double>::infinity();
  int evaluations = 0;

  void operator()(std::span<const Index>,
                  physinv::BatchIn<double> x,
                  physinv::VectorOut<double> loss,
                  physinv::BatchOut<double> gradient) {
    evaluations += static_cast<int>(x.cols());
    gradient = x.array() - 3;
    for (Index j = 0; j < x.cols(); ++j)
      loss(j) =
          x(0, j) > wall ? kNan : (x.col(j).array() - 3).square().sum() / 2;
  }
};

struct Solved {
  LibrarySolver solver;
  Bowl bowl;
  physinv::Outcome out;

  Solved(Library library, Bowl b = {}, Index n = 3, const Task& task = kTask)
      : solver(std::move(library), task), bowl(b) {
    physinv::Batch<double> x0 = physinv::Batch<double>::Zero(2, n);
    for (Index j = 0; j < n; ++j) x0(1, j) = static_cast<double>(j);
    physinv::drive(solver, bowl, x0);
    solver.report(out);
  }
  double array(const char* name, Index i = 0) const {
    return out.arrays.at(physinv::ArrayKey::own(name))(0, i);
  }
};

/// Two steps of length 1 / 2, each an iterate.
LibraryEnd descend(Objective& f, const Vector<double>& x0, Index) {
  Vector<double> x = x0, g(x0.size());
  double loss = f.evaluate(x.data(), g.data());
  for (int k = 0; k < 2; ++k) {
    x -= g / 2;
    loss = f.evaluate(x.data(), g.data());
    f.iterate(x.data());
  }
  return {x, loss, Status::gtol, true, "done"};
}

TEST(LibrarySolver, IsASolverOfTheSuite) {
  const Solved s(descend);
  EXPECT_EQ(s.bowl.evaluations, 9);  // the start is not evaluated twice
  for (Index i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(s.solver.iterations()[at], 2);
    EXPECT_EQ(s.solver.evaluations()[at], 3);
    EXPECT_EQ(s.solver.status()[at], Status::gtol);
    EXPECT_EQ(s.solver.x()(0, i), 2.25);
    EXPECT_EQ(s.array("claims_success", i), 1);
    EXPECT_EQ(s.array("returned_not_best", i), 0);
    EXPECT_EQ(s.array("false_loss", i), 0);
    EXPECT_EQ(s.array("gradient_left", i), 0.75);
  }
  EXPECT_EQ(s.out.message, "3 x done");
}

TEST(LibrarySolver, ASearchWithoutEndEndsWithTheBudget) {
  const Solved s([](Objective& f, const Vector<double>& x0, Index) {
    Vector<double> x = x0, g(x0.size());
    for (;;) x(0) -= 1, f.evaluate(x.data(), g.data());
    return LibraryEnd{};
  });
  EXPECT_EQ(s.solver.status()[0], Status::maxiter);
  EXPECT_EQ(s.solver.evaluations()[0], kBudget + 1);
  EXPECT_EQ(s.solver.x()(0, 0), 0);
  EXPECT_EQ(s.array("budget_spent"), 1);
}

TEST(LibrarySolver, WhoSwallowsTheEndIsLeft) {
  const Solved s([](Objective& f, const Vector<double>& x0, Index) {
    Vector<double> x = x0, g(x0.size());
    for (;;) {
      try {
        x(0) += 1;
        f.evaluate(x.data(), g.data());
      } catch (...) {
      }
    }
    return LibraryEnd{};
  });
  EXPECT_EQ(s.solver.status()[2], Status::maxiter);
  EXPECT_EQ(s.array("budget_spent", 2), 1);
  EXPECT_NE(s.out.message.find("went on"), s.out.message.npos);
}

TEST(LibrarySolver, EvaluationsAtOnePointAreBounded) {
  const Solved s([](Objective& f, const Vector<double>& x0, Index) {
    Vector<double> g(x0.size());
    for (;;) f.evaluate(x0.data(), g.data());
    return LibraryEnd{};
  });
  EXPECT_EQ(s.bowl.evaluations, 3);
  EXPECT_EQ(s.array("budget_spent"), 1);
}

TEST(LibrarySolver, WhatALibraryThrowsIsItsMessage) {
  const Solved s([](Objective&, const Vector<double>&, Index) -> LibraryEnd {
    throw std::runtime_error("no minimum here");
  });
  EXPECT_EQ(s.solver.status()[0], Status::linesearch);
  EXPECT_EQ(s.out.message, "3 x no minimum here");
  EXPECT_EQ(s.array("claims_success"), 0);
}

TEST(LibrarySolver, NanIsNoResult) {
  const auto library = [](Objective& f, const Vector<double>& x0, Index) {
    Vector<double> x = x0, g(x0.size());
    f.evaluate(x.data(), g.data());
    x(0) = 2;
    f.evaluate(x.data(), g.data());
    x(0) = kNan;  // is not shown to the problem
    const double loss = f.evaluate(x.data(), g.data());
    EXPECT_TRUE(std::isnan(loss));
    return LibraryEnd{x, loss, Status::gtol, true, "converged"};
  };
  const Solved s(library, {.wall = 1});
  EXPECT_EQ(s.bowl.evaluations, 6);
  EXPECT_EQ(s.solver.status()[0], Status::nonfinite);
  EXPECT_EQ(s.solver.x()(0, 0), 0);
  EXPECT_EQ(s.array("claims_success"), 1);
}

TEST(LibrarySolver, WhatIsReturnedIsHeldAgainstWhatWasSeen) {
  const Solved s([](Objective& f, const Vector<double>& x0, Index) {
    Vector<double> x = x0, g(x0.size());
    f.evaluate(x.data(), g.data());
    x(0) = 3;
    const double low = f.evaluate(x.data(), g.data());
    x(0) = -1;  // not evaluated
    return LibraryEnd{x, low, Status::gtol, true, "converged"};
  });
  EXPECT_EQ(s.solver.x()(0, 0), -1);
  EXPECT_EQ(s.solver.loss()(0), 12.5);
  EXPECT_EQ(s.array("returned_not_best"), 1);
  EXPECT_EQ(s.array("false_loss"), 1);
}

TEST(LibrarySolver, PointsOutsideOfTheBoundsAreCounted) {
  const auto library = [](Objective& f, const Vector<double>& x0, Index) {
    Vector<double> x = x0, g(x0.size());
    for (const double a : {0.0, 1.0, 1.5, -0.5, kNan})
      x(0) = a, f.evaluate(x.data(), g.data());
    return LibraryEnd{x0, kNan, Status::gtol, true, "converged"};
  };
  Task task = kTask;
  EXPECT_FALSE(Solved(library).out.arrays.contains(
      physinv::ArrayKey::own("outside_box")));
  task.lower = {0, 0}, task.upper = {1, 1};
  const Solved s(library, {}, 3, task);
  EXPECT_EQ(s.array("outside_box", 0), 3);
  EXPECT_EQ(s.array("outside_box", 2), 5);  // starts outside
}

}  // namespace
}  // namespace libraries
