#include "optimizers/lbfgsb.h"

#include <gtest/gtest.h>

#include <limits>

#include "suite/core/check.h"
#include "tests/optimizers/functions.h"
#include "tests/support/bits.h"
#include "tests/support/run_reference.h"

namespace physinv {
namespace {

using test::ClosedForm;
using test::Json;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Start j of a batch: spread over [-3, 3]^d.
Batch<double> starts(Index d, Index n) {
  Batch<double> x(d, n);
  for (Index i = 0; i < x.size(); ++i)
    x(i) = 3 * std::sin(1.3 * static_cast<double>(i * i) + 0.4);
  return x;
}

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

Lbfgsb solve(const std::string& name,
             BatchIn<double> x0,
             LbfgsbOptions o = {}) {
  Lbfgsb solver(std::move(o));
  drive(solver, ClosedForm{name}, x0);
  return solver;
}

TEST(Lbfgsb, BatchEqualsSoloRunsAndPermutationsBitwise) {
  const Index n = 23;
  const LbfgsbOptions boxed{.memory = 3, .lower = {-2}, .upper = {0.9}};
  for (const LbfgsbOptions& options : {LbfgsbOptions{}, boxed}) {
    for (const Index d : {1, 2, 7}) {
      for (const char* name : {"wavy", "rosenbrock", "quadratic"}) {
        const Batch<double> x0 = starts(d, n);
        const Lbfgsb all = solve(name, x0, options);
        const Lbfgsb reversed = solve(name, x0.rowwise().reverse(), options);
        Index made = 0;
        for (Index i = 0; i < n; ++i) {
          const auto at = static_cast<std::size_t>(i);
          const Lbfgsb one = solve(name, x0.col(i), options);
          const Vector<double> x = all.x().col(i),
                               mirror = reversed.x().col(n - 1 - i);
          EXPECT_TRUE(test::same_bits(x, Vector<double>(one.x().col(0))));
          EXPECT_TRUE(test::same_bits(x, mirror));
          EXPECT_EQ(all.status()[at], one.status()[0]);
          EXPECT_EQ(all.evaluations()[at], one.evaluations()[0]);
          made += all.evaluations()[at];
        }
        EXPECT_EQ(static_cast<std::uint64_t>(made) + all.skipped_evaluations(),
                  static_cast<std::uint64_t>(n * all.rounds()));
      }
    }
  }
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
  const auto walled = [](std::span<const Index>,
                         BatchIn<double> x,
                         VectorOut<double> loss,
                         BatchOut<double> gradient) {
    for (Index i = 0; i < x.cols(); ++i) {
      loss(i) = 4 * x(0, i) - std::log(x(0, i));
      gradient(0, i) = 4 - 1 / x(0, i);
      if (x(0, i) < 0) loss(i) = kNan;
    }
  };
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
  const auto wrong = [](std::span<const Index>,
                        BatchIn<double> x,
                        VectorOut<double> loss,
                        BatchOut<double> gradient) {
    for (Index i = 0; i < x.cols(); ++i) {
      loss(i) = x(0, i);
      gradient(0, i) = -1;
    }
  };
  Lbfgsb solver;
  drive(solver, wrong, Batch<double>::Ones(1, 1));
  EXPECT_EQ(solver.status()[0], Status::linesearch);
  EXPECT_EQ(solver.x()(0), 1);
  EXPECT_EQ(solver.loss()(0), 1);
}

TEST(Lbfgsb, APlateauAndAMinimumAreToldApart) {
  // 1 + x^4: the loss hardly falls long before the gradient is small.
  const auto valley = [](std::span<const Index>,
                         BatchIn<double> x,
                         VectorOut<double> loss,
                         BatchOut<double> gradient) {
    for (Index i = 0; i < x.cols(); ++i) {
      loss(i) = 1 + std::pow(x(0, i), 4);
      gradient(0, i) = 4 * std::pow(x(0, i), 3);
    }
  };
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
    const auto walled = [wall](std::span<const Index>,
                               BatchIn<double> x,
                               VectorOut<double> loss,
                               BatchOut<double> gradient) {
      for (Index i = 0; i < x.cols(); ++i) {
        loss(i) = x(0, i) > 0 ? wall : -x(0, i);
        gradient(0, i) = -1;
      }
    };
    Lbfgsb solver;
    drive(solver, walled, Batch<double>::Zero(1, 1));
    EXPECT_EQ(solver.status()[0], Status::nonfinite);
    EXPECT_EQ(solver.x()(0), 0);
  }
}

TEST(Lbfgsb, AStartThatIsNotFiniteIsLeftAsItIs) {
  const auto blind = [](std::span<const Index>,
                        BatchIn<double> x,
                        VectorOut<double> loss,
                        BatchOut<double> gradient) {
    EXPECT_TRUE(x.allFinite());
    gradient.setZero();
    for (Index i = 0; i < x.cols(); ++i) {
      loss(i) = x(0, i) * x(0, i);
      gradient(0, i) = 2 * x(0, i);
    }
  };
  const LbfgsbOptions boxed{.lower = {-2}, .upper = {0.9}};
  const LbfgsbOptions below{.lower = {-2}};
  const Batch<double> good = starts(2, 3);
  for (const LbfgsbOptions& options : {LbfgsbOptions{}, boxed, below}) {
    Lbfgsb alone(options);
    drive(alone, blind, good);
    for (const double bad : {kNan, kInf, -kInf}) {
      Batch<double> x0(2, 4);
      x0.col(0) << 0.5, bad;
      x0.rightCols(3) = good;
      Lbfgsb solver(options);
      drive(solver, blind, x0);
      EXPECT_EQ(solver.status()[0], Status::nonfinite);
      EXPECT_EQ(solver.evaluations()[0], 0);
      EXPECT_EQ(solver.iterations()[0], 0);
      EXPECT_TRUE(test::same_bits(Vector<double>(solver.x().col(0)),
                                  Vector<double>(x0.col(0))));
      EXPECT_TRUE(
          test::same_bits(Batch<double>(solver.x().rightCols(3)), alone.x()));
      EXPECT_EQ(solver.status()[1], alone.status()[0]);
    }
  }
}

TEST(Lbfgsb, EvaluatesNoPointTwiceInARow) {
  // At the bound already: the step has no length, its point is the start.
  const auto flat = [](std::span<const Index>,
                       BatchIn<double> x,
                       VectorOut<double> loss,
                       BatchOut<double> gradient) {
    for (Index i = 0; i < x.cols(); ++i) {
      loss(i) = 1 + 1e-20 * x(0, i);
      gradient(0, i) = 1;
    }
  };
  Lbfgsb solver({.lower = {-1e-30}});
  std::vector<Index> seen;
  Vector<double> last;
  drive(
      solver,
      [&](std::span<const Index> active,
          BatchIn<double> x,
          VectorOut<double> loss,
          BatchOut<double> gradient) {
        EXPECT_FALSE(last.size() > 0 && test::same_bits(last, x.col(0).eval()));
        last = x.col(0);
        flat(active, x, loss, gradient);
      },
      Batch<double>::Ones(1, 1),
      [&](const Lbfgsb& s) { seen.push_back(s.iterations()[0]); });
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
