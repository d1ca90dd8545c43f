/// Properties every problem with a full Jacobian has, on given inputs.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/support/bits.h"
#include "tests/support/gradient_check.h"
#include "tests/support/physics.h"
#include "tests/support/tolerance.h"

namespace physinv::test {

/// Jacobian against central differences, pullback against the Jacobian.
template <class P>
void expect_derivatives(const P& problem,
                        const Batch<double>& x,
                        const Batch<double>& given,
                        double rtol = 1e-7) {
  Physics at(problem);
  const Batch<double> j = at.jacobian(x, given);
  const Batch<double> y_bar =
      waves<double>(problem.shape().observations, x.cols(), 0.4);
  const Batch<double> x_bar = at.gradient(x, given, y_bar);
  for (Index i = 0; i < x.cols(); ++i) {
    SCOPED_TRACE(i);
    const Batch<double> ji = at.matrix(j, i);
    const auto f = [&](const Vector<double>& v) {
      return Vector<double>(at.forward(v, given.col(i)).col(0));
    };
    EXPECT_TRUE(Comparator(rtol, 1e-12)(ji, difference_jacobian(f, x.col(i))));
    EXPECT_GT(ji.norm(), 0);
    EXPECT_TRUE(Comparator(1e-11, 1e-14)(Vector<double>(x_bar.col(i)),
                                         ji.transpose() * y_bar.col(i)));
  }
}

/// No answer of a sample depends, to the last bit, on the batch around it or
/// on the number of threads.
template <class T, class P>
void expect_independent_samples(const P& problem,
                                const Batch<T>& x,
                                const Batch<T>& given) {
  Physics at(problem), threaded(problem, 3);
  const Index n = x.cols();
  const Batch<T> y_bar = waves<T>(problem.shape().observations, n, 0.4);
  const Batch<T> y = at.forward(x, given), j = at.jacobian(x, given);
  EXPECT_TRUE(same_bits(at.linearize(x, given), y));
  const Batch<T> x_bar = at.pullback(y_bar);
  EXPECT_TRUE(x_bar.allFinite() && j.allFinite());
  EXPECT_TRUE(same_bits(threaded.forward(x, given), y));
  EXPECT_TRUE(same_bits(threaded.gradient(x, given, y_bar), x_bar));
  EXPECT_TRUE(same_bits(threaded.jacobian(x, given), j));
  std::vector<std::vector<Index>> subsets = {{n - 1, 0, 3, 2, n / 2}};
  for (const Index i : {Index{0}, Index{1}, n / 2, n - 1})
    subsets.push_back({i});
  for (const auto& some : subsets) {
    const auto of = [&](const Batch<T>& all) {
      return Batch<T>(all(Eigen::all, some));
    };
    EXPECT_TRUE(same_bits(at.forward(of(x), of(given)), of(y)));
    EXPECT_TRUE(same_bits(at.gradient(of(x), of(given), of(y_bar)), of(x_bar)));
    EXPECT_TRUE(same_bits(at.jacobian(of(x), of(given)), of(j)));
  }
}

/// Sample `bad` of x diverges: it says so in y, gradient and Jacobian, and no
/// other column changes.
template <class T, class P>
void expect_contained(const P& problem,
                      const Batch<T>& good,
                      const Batch<T>& given,
                      const Batch<T>& x,
                      Index bad) {
  Physics at(problem);
  const Batch<T> y_bar = waves<T>(problem.shape().observations, x.cols(), 0.4);
  const auto check = [&](const Batch<T>& expected, Batch<T> seen) {
    EXPECT_FALSE(seen.col(bad).allFinite());
    seen.col(bad) = expected.col(bad);
    EXPECT_TRUE(same_bits(seen, expected));
  };
  check(at.forward(good, given), at.forward(x, given));
  check(at.gradient(good, given, y_bar), at.gradient(x, given, y_bar));
  check(at.jacobian(good, given), at.jacobian(x, given));
}

}  // namespace physinv::test
