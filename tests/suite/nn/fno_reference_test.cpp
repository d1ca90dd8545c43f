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

/// Weights of the entry's rule, counted through all tensors.
template <class T>
void use_rule(const Json& rule, Bench<T>& b) {
  const auto a = rule.at("a").get<std::int64_t>();
  const auto slope = rule.at("b").get<std::int64_t>();
  const auto first = rule.at("c").get<std::int64_t>();
  const auto m = rule.at("m").get<std::int64_t>();
  std::size_t number = 0;
  for (const TensorInfo& t : b.net->tensors()) {
    Index size = 1;
    for (const Json& extent : rule.at("shapes").at(number))
      size *= extent.get<Index>();
    const auto name = rule.at("order").at(number++).get<std::string>();
    ASSERT_EQ(t.size, size) << name;
    ASSERT_EQ(t.kind == 'f', name.starts_with("spec")) << name;
    const double scale = t.kind == 'f' ? 64 : std::sqrt(double(t.fan_in));
    for (Index i = t.offset; i < t.offset + t.size; ++i) {
      const std::int64_t r = ((a * i + slope) * i + first) % m;
      b.p(i) = static_cast<T>((2 * double(r) / double(m - 1) - 1) / scale);
    }
  }
  ASSERT_EQ(number, rule.at("order").size());
}

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

Vector<double> flat(const Json& list) {
  const Batch<double> columns = test::columns(list);
  return Eigen::Map<const Vector<double>>(columns.data(), columns.size());
}

template <class T>
class FnoReference : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(FnoReference, Precisions);

TYPED_TEST(FnoReference, OutputLossAndGradients) {
  using T = TypeParam;
  const auto entries = test::reference_entries("sip-poisson", "fno");
  ASSERT_EQ(entries.size(), 1U);
  const Json& e = entries[0];
  const Json &in = e.at("inputs"), &expected = e.at("expected");
  const Index rows = Index(in.at("y").size());
  const Index columns = Index(in.at("y").at(0).size());
  const Index cells = rows * columns;
  Bench<T> b(fno({.grid = {.columns = columns, .rows = rows}}), cells, cells);
  use_rule(in.at("weights"), b);
  const Comparator close =
      sizeof(T) == 4 ? Comparator(1e-4, 0)
                     : test::EntryTolerance(e.at("tolerance")).array();

  std::size_t read = 0;
  const auto want = [&](const char* key) -> const Json& {
    ++read;
    return expected.at(key);
  };
  EXPECT_EQ(b.net->parameter_count(),
            want("real_numbers").template get<Index>());
  const Vector<double> y = flat(in.at("y"));
  const Vector<double> x =
      b.forward(y.template cast<T>()).template cast<double>();
  EXPECT_TRUE(close(x, flat(want("output"))));

  const Eigen::LLT<Batch<double>> solver(minus_laplacian(rows, columns));
  const Vector<double> residual = -solver.solve(x) - y;
  EXPECT_TRUE(
      close(residual.squaredNorm() / 2, want("loss").template get<double>()));

  const Vector<double> x_bar = -solver.solve(residual);
  const Vector<T> bar = b.parameters_bar(x_bar.template cast<T>());
  const Vector<double> norms = test::vector(want("gradient_norms"));
  const auto& tensors = b.net->tensors();
  ASSERT_EQ(Index(tensors.size()), norms.size());
  for (std::size_t t = 0; t < tensors.size(); ++t)
    EXPECT_TRUE(close(bar.segment(tensors[t].offset, tensors[t].size)
                          .template cast<double>()
                          .norm(),
                      norms(Index(t))))
        << in.at("weights").at("order").at(t);
  EXPECT_EQ(read, expected.size());
}

}  // namespace
}  // namespace physinv::nn
