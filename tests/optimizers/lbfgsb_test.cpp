#include "optimizers/lbfgsb.h"

#include <gtest/gtest.h>

#include <limits>

#include "suite/core/check.h"
#include "tests/optimizers/solver_checks.h"
#include "tests/support/run_reference.h"

namespace physinv {
namespace {

using test::ClosedForm;
using test::Json;
using test::single;
using test::starts;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// What SciPy calls success is one of three: the gradient is small, the loss
/// hardly fell, or a step to the start itself left it as it is.
Status status_of(const Json& stored, const test::RecordedRun& run) {
  const std::string message = stored.at("message");
  EXPECT_EQ(stored.at("status").get<int>(), message.starts_with("STOP"));
  const Index last = run.iterates.cols() - 1;
  if (message.ends_with("_PGTOL")) return Status::gtol;
  if (message.starts_with("STOP")) return Status::maxiter;
  return last > 0 && run.iterates.col(last) == run.iterates.col(last - 1)
             ? Status::linesearch
             : Status::ftol;
}

std::vector<double> bounds(const Json& list, double none) {
  std::vector<double> out;
  if (list.is_null()) return out;
  for (const Json& value : list)
    out.push_back(value.is_null() ? none : test::number(value));
  return out;
}

LbfgsbOptions options_of(const Json& stored) {
  LbfgsbOptions options;
  options.lower = bounds(stored.at("lower"), -kInf);
  options.upper = bounds(stored.at("upper"), kInf);
  for (const auto& [key, value] : stored.at("options").items()) {
    if (key == "maxcor")
      options.memory = value;
    else if (key == "gtol")
      options.pgtol = value;
    else if (key == "ftol")
      options.ftol = value;
    else if (key == "maxiter")
      options.maxiter = value;
    else if (key == "maxfun")
      options.maxfun = value;
    else
      ADD_FAILURE() << "unknown option " << key;
  }
  return options;
}

TEST(LbfgsbReference, EveryIterateAndCountIsThatOfSciPy) {
  const auto check = [](const Json& entry) {
    const auto near = test::EntryTolerance(entry).array();
    for (const Json& stored : entry.at("runs")) {
      SCOPED_TRACE(stored.at("function").dump() + stored.at("x0").dump() +
                   stored.at("lower").dump() + stored.at("options").dump() +
                   stored.at("message").dump());
      const ClosedForm f{stored.at("function").get<std::string>()};
      const auto run = test::record(
          Lbfgsb(options_of(stored)), f, test::vector(stored.at("x0")));
      EXPECT_EQ(run.iterations, stored.at("iterations").get<Index>());
      EXPECT_EQ(run.evaluations, stored.at("evaluations").get<Index>());
      EXPECT_EQ(run.status, status_of(stored, run));
      EXPECT_TRUE(near(run.iterates, test::columns(stored.at("iterates"))));
      EXPECT_TRUE(near(run.losses, test::vector(stored.at("losses"))));
    }
  };
  if (!test::has_reference("lbfgsb"))
    GTEST_SKIP() << "no lbfgsb.json in " << test::reference_dir();
  test::check_entries("lbfgsb", {{"lbfgsb", check}});
}

Lbfgsb solve(const char* name, BatchIn<double> x0, const LbfgsbOptions& o) {
  return test::solved<Lbfgsb>(ClosedForm{name}, x0, o);
}

TEST(Lbfgsb, BatchEqualsSoloRunsAndPermutationsBitwise) {
  const LbfgsbOptions boxed{.memory = 3, .lower = {-2}, .upper = {0.9}};
  for (const LbfgsbOptions& options : {LbfgsbOptions{}, boxed})
    for (const Index d : {1, 2, 7})
      for (const char* name : {"wavy", "rosenbrock", "quadratic"})
        test::expect_independent_problems<Lbfgsb>(name, starts(d, 23), options);
}

TEST(Lbfgsb, IteratesStayInTheBoxAndDescend) {
  const Index n = 30;
  Vector<double> last =
      Vector<double>::Constant(n, std::numeric_limits<double>::infinity());
  Lbfgsb solver({.lower = {-1, -0.5, 0.2}, .upper = {1.5, 0.4, 0.2}});
  drive(solver, ClosedForm{"rosenbrock"}, starts(3, n), [&](const Lbfgsb& s) {
    for (const Index i : s.accepted()) {
      EXPECT_LE(s.loss()(i), last(i));
      last(i) = s.loss()(i);
      EXPECT_GE(s.x()(0, i), -1);
      EXPECT_LE(s.x()(1, i), 0.4 + 1e-15);
      EXPECT_EQ(s.x()(2, i), 0.2);
    }
  });
  for (const Status s : solver.status()) EXPECT_TRUE(converged(s));
}

TEST(Lbfgsb, ValuesThatAreNotFiniteAreNeverAccepted) {
  const auto walled = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = 4 - 1 / x(0);
    return x(0) < 0 ? kNan : 4 * x(0) - std::log(x(0));
  });
  Lbfgsb solver;
  drive(solver, walled, starts(1, 40).cwiseAbs().array() + 0.02);
  EXPECT_TRUE(solver.x().allFinite());
  EXPECT_TRUE(solver.loss().allFinite());
  EXPECT_GT(solver.x().minCoeff(), 0);
  drive(solver, walled, Batch<double>::Constant(1, 1, -1));
  EXPECT_EQ(solver.status()[0], Status::nonfinite);
  EXPECT_EQ(solver.evaluations()[0], 1);
}

// The gradient points uphill, so that no step lowers the loss.
TEST(Lbfgsb, ASearchThatFindsNoStepHasNotConverged) {
  const auto wrong = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = -1;
    return x(0);
  });
  Lbfgsb solver;
  drive(solver, wrong, Batch<double>::Ones(1, 1));
  EXPECT_EQ(solver.status()[0], Status::linesearch);
  EXPECT_EQ(solver.x()(0), 1);
  EXPECT_EQ(solver.loss()(0), 1);
}

TEST(Lbfgsb, APlateauAndAMinimumAreToldApart) {
  // 1 + x^4: the loss hardly falls long before the gradient is small.
  const auto valley = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = 4 * std::pow(x(0), 3);
    return 1 + std::pow(x(0), 4);
  });
  const Batch<double> x0 = Batch<double>::Constant(1, 1, 2);
  Lbfgsb plateau({.pgtol = 1e-12});
  drive(plateau, valley, x0);
  EXPECT_EQ(plateau.status()[0], Status::ftol);
  EXPECT_GT(plateau.gradient()(0), 1e-12);
  Lbfgsb minimum({.pgtol = 1e-5, .ftol = 0});
  drive(minimum, valley, x0);
  EXPECT_EQ(minimum.status()[0], Status::gtol);
  EXPECT_LT(minimum.gradient()(0), 1e-5);
}

// A wall of +inf or NaN: the search without a step ends where it began.
TEST(Lbfgsb, WallsAreNoMinima) {
  for (const double wall : {kInf, kNan}) {
    const auto walled =
        single([wall](const Vector<double>& x, Vector<double>& g) {
          g(0) = -1;
          return x(0) > 0 ? wall : -x(0);
        });
    Lbfgsb solver;
    drive(solver, walled, Batch<double>::Zero(1, 1));
    EXPECT_EQ(solver.status()[0], Status::nonfinite);
    EXPECT_EQ(solver.x()(0), 0);
  }
}

TEST(Lbfgsb, AStartThatIsNotFiniteIsLeftAsItIs) {
  const LbfgsbOptions boxed{.lower = {-2}, .upper = {0.9}};
  const LbfgsbOptions below{.lower = {-2}};
  for (const LbfgsbOptions& options : {LbfgsbOptions{}, boxed, below})
    test::expect_bad_starts_stay<Lbfgsb>(options);
}

TEST(Lbfgsb, EvaluatesNoPointTwiceInARow) {
  // At the bound already: the step has no length, its point is the start.
  Vector<double> last;
  const auto flat = single([&](const Vector<double>& x, Vector<double>& g) {
    EXPECT_FALSE(last.size() > 0 && test::same_bits(last, x));
    last = x;
    g(0) = 1;
    return 1 + 1e-20 * x(0);
  });
  Lbfgsb solver({.lower = {-1e-30}});
  std::vector<Index> seen;
  drive(solver, flat, Batch<double>::Ones(1, 1), [&](const Lbfgsb& s) {
    seen.push_back(s.iterations()[0]);
  });
  for (std::size_t k = 0; k < seen.size(); ++k)
    EXPECT_EQ(seen[k], static_cast<Index>(k));
}

TEST(Lbfgsb, SaysWhatIsWrongWithItsBounds) {
  EXPECT_THROW(solve("wavy", starts(3, 1), {.lower = {0, 0}}), ContractError);
  EXPECT_THROW(solve("wavy", starts(3, 1), {.lower = {1}, .upper = {0}}),
               ContractError);
  for (const LbfgsbOptions& bad : {LbfgsbOptions{.lower = {kNan}},
                                   LbfgsbOptions{.upper = {kNan}},
                                   LbfgsbOptions{.lower = {kInf}},
                                   LbfgsbOptions{.upper = {-kInf}},
                                   LbfgsbOptions{.memory = 0},
                                   LbfgsbOptions{.pgtol = kNan},
                                   LbfgsbOptions{.ftol = kNan},
                                   LbfgsbOptions{.ftol = -1},
                                   LbfgsbOptions{.maxiter = -1},
                                   LbfgsbOptions{.maxls = 0}})
    EXPECT_THROW(solve("wavy", starts(3, 1), bad), ContractError);
}

TEST(SaddleFactor, SolvesItsSystem) {
  const Index k = 4;
  Batch<double> p = starts(k, k), r = starts(k, 2 * k).rightCols(k);
  Batch<double> q = Batch<double>::Identity(k, k), whole(2 * k, 2 * k);
  p = (p * p.transpose()).eval() + Batch<double>::Identity(k, k);
  whole << -p, r.transpose(), r, q;
  SaddleFactor factor;
  factor.reserve(k + 2);
  ASSERT_TRUE(factor.factor(k, p, r, q));
  Vector<double> v = starts(2 * k, 1);
  const Vector<double> b = v;
  factor.solve(k, v.data(), v.data());
  EXPECT_TRUE(test::Comparator(1e-12, 1e-12)(Vector<double>(whole * v), b));
  EXPECT_FALSE(factor.factor(k, -p, r, q));
}

}  // namespace
}  // namespace physinv
