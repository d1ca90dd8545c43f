// The Fourier network's entry of sip-poisson. The physics is 16 x 16 cells,
// solved here by a dense factorization.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "suite/nn/fno.h"
#include "tests/suite/nn/nn_testing.h"
#include "tests/support/reference.h"

namespace physinv::nn {
namespace {

using test::Comparator;
using test::Json;

/// Minus the 5-point Laplacian with zeros around, cells row by row.
Batch<double> minus_laplacian(Index rows, Index columns) {
  Batch<double> a = 4 * Batch<double>::Identity(rows * columns, rows * columns);
  const auto join = [&](Index p, Index q) { a(p, q) = a(q, p) = -1; };
  for (Index p = 0; p < rows * columns; ++p) {
    if (p % columns > 0) join(p, p - 1);
    if (p >= columns) join(p, p - columns);
  }
  return a;
}

template <class T>
void check_fno(const Json& e) {
  const Json in = e.at("inputs"), expected = e.at("expected");
  const Index rows = Index(in.at("y").size());
  const Index columns = Index(in.at("y").at(0).size());
  const Index cells = rows * columns;
  Bench<T> b(fno({.grid = {.columns = columns, .rows = rows}}), cells, cells);
  const auto& tensors = b.net->tensors();
  const Json order = in.at("weights").at("order");
  ASSERT_EQ(order.size(), tensors.size());
  for (std::size_t t = 0; t < tensors.size(); ++t)
    EXPECT_EQ(tensors[t].kind == 'f',
              order.at(t).get<std::string>().starts_with("spec"))
        << order.at(t);
  b.p = test::recurrence_weights(in.at("weights"), tensors).template cast<T>();
  const Comparator close =
      sizeof(T) == 4 ? Comparator(1e-4, 0)
                     : test::EntryTolerance(e.at("tolerance")).array();

  EXPECT_EQ(b.net->parameter_count(),
            expected.at("real_numbers").template get<Index>());
  const Vector<double> y = test::field(in.at("y"));
  const Vector<double> x =
      b.forward(y.template cast<T>()).template cast<double>();
  EXPECT_TRUE(close(x, test::field(expected.at("output"))));

  const Eigen::LLT<Batch<double>> solver(minus_laplacian(rows, columns));
  const Vector<double> residual = -solver.solve(x) - y;
  EXPECT_TRUE(
      close(residual.squaredNorm() / 2, test::number(expected.at("loss"))));

  const Vector<double> x_bar = -solver.solve(residual);
  const Vector<T> bar = b.parameters_bar(x_bar.template cast<T>());
  const Vector<double> norms =
      test::tensor_norms(tensors, bar.template cast<double>());
  const Vector<double> stored = test::vector(expected.at("gradient_norms"));
  ASSERT_EQ(norms.size(), stored.size());
  for (Index t = 0; t < norms.size(); ++t)
    EXPECT_TRUE(close(norms(t), stored(t))) << order.at(std::size_t(t));
}

TEST(FnoReference, OutputLossAndGradients) {
  test::check_entries_named(
      "sip-poisson", "fno", test::in_both(check_fno<float>, check_fno<double>));
}

}  // namespace
}  // namespace physinv::nn
