/// What every batched solver promises, by its class.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "optimizers/drive.h"
#include "tests/optimizers/functions.h"
#include "tests/support/bits.h"

namespace physinv::test {

template <class Solver, class F, class Options>
Solver solved(F&& objective, BatchIn<double> x0, const Options& options) {
  Solver solver(options);
  drive(solver, objective, x0);
  return solver;
}

/// Problem i of one solver ends as problem j of the other, to the last bit.
template <class Solver>
void expect_same_end(const Solver& a, Index i, const Solver& b, Index j) {
  const auto k = static_cast<std::size_t>(i), l = static_cast<std::size_t>(j);
  EXPECT_TRUE(
      same_bits(Vector<double>(a.x().col(i)), Vector<double>(b.x().col(j))));
  EXPECT_EQ(a.loss()(i), b.loss()(j));
  EXPECT_EQ(a.status()[k], b.status()[l]);
  EXPECT_EQ(a.evaluations()[k], b.evaluations()[l]);
  EXPECT_EQ(a.iterations()[k], b.iterations()[l]);
}

/// A batch equals solo runs and its permutation; finished problems save
/// evaluations.
template <class Solver, class Options>
void expect_independent_problems(const char* name,
                                 const Batch<double>& x0,
                                 const Options& options) {
  const ClosedForm f{name};
  const Index n = x0.cols();
  const auto all = solved<Solver>(f, x0, options);
  const auto reversed = solved<Solver>(f, x0.rowwise().reverse(), options);
  Index made = 0;
  for (Index i = 0; i < n; ++i) {
    expect_same_end(all, i, solved<Solver>(f, x0.col(i), options), 0);
    expect_same_end(all, i, reversed, n - 1 - i);
    made += all.evaluations()[static_cast<std::size_t>(i)];
  }
  EXPECT_EQ(static_cast<std::uint64_t>(made) + all.skipped_evaluations(),
            static_cast<std::uint64_t>(n * all.rounds()));
}

/// A start that is not finite is left as it is, and no other problem is
/// disturbed.
template <class Solver, class Options>
void expect_bad_starts_stay(const Options& options) {
  // An objective that would find it acceptable.
  const auto blind = single([](const Vector<double>& x, Vector<double>& g) {
    EXPECT_TRUE(x.allFinite());
    g(0) = 2 * x(0);
    return x(0) * x(0);
  });
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto alone = solved<Solver>(blind, starts(2, 3), options);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), kInf, -kInf}) {
    Batch<double> x0(2, 5);
    x0.col(0) << 0.5, bad;
    x0.middleCols(1, 3) = starts(2, 3);
    x0.col(4) << bad, bad;
    const auto b = solved<Solver>(blind, x0, options);
    for (const std::size_t i : {std::size_t{0}, std::size_t{4}}) {
      EXPECT_EQ(b.status()[i], Status::nonfinite);
      EXPECT_EQ(b.evaluations()[i], 0);
      EXPECT_EQ(b.iterations()[i], 0);
    }
    EXPECT_TRUE(same_bits(Batch<double>(b.x()(Eigen::all, {0, 4})),
                          Batch<double>(x0(Eigen::all, {0, 4}))));
    for (Index i = 0; i < 3; ++i) expect_same_end(b, i + 1, alone, i);
    const auto none = Batch<double>::Constant(2, 2, bad);
    EXPECT_EQ(solved<Solver>(blind, none, options).rounds(), 0);
  }
}

}  // namespace physinv::test
