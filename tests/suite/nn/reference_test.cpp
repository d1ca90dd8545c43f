// The network's part of the independent vectors of jpo-billiards.

#include "tests/support/reference.h"

#include <gtest/gtest.h>

#include "suite/nn/encoding.h"
#include "suite/nn/mlp.h"
#include "tests/suite/nn/nn_testing.h"
#include "tests/support/formula_weights.h"

namespace physinv::nn {
namespace {

using test::Json;

template <class T>
Batch<T> batch(const Json& samples,
               Index features = test::kAny,
               Index count = test::kAny) {
  return test::columns(samples, features, count).template cast<T>();
}

template <class T>
void check_encoding(const Json& e) {
  const Batch<T> in = batch<T>(e["input"]);
  const Batch<double> expected = batch<double>(e["output"]);
  ASSERT_GE(in.rows(), 1);
  // Sines and cosines of one to `frequencies` times each number.
  const Index frequencies = expected.rows() / (2 * in.rows());
  Bench<T> b(network([&]<class U>() {
               return layers(positional_encoding<U>(in.rows(), frequencies));
             }),
             0,
             0);
  ASSERT_EQ(b.net->outputs(), expected.rows());
  const Batch<T> out = b.forward(in);
  // Rounding the input to float already moves sin(4a).
  const double tol = test::number(e["atol"]);
  EXPECT_TRUE(test::Comparator(0, sizeof(T) == 4 ? 1e-6 : tol)(out, expected));
}

/// The rest of the entry is checked by the stage itself.
template <class T>
void check_first_step(const Json& e) {
  // The rest is read by the test of the stage itself.
  for (const Json& each : e["steps"]) each.items();
  const Json step = e["steps"][0];
  const double rtol = sizeof(T) == 4 ? 1e-4 : test::number(e["rtol"]);
  const Batch<T> balls = batch<T>(e["balls"], 2);
  Batch<T> in(4, balls.cols());
  in.topRows(2) = balls;
  in.row(2).setConstant(T(2));  // the target of the specification
  in.row(3).setConstant(T(0.5));
  const auto sizes = test::layer_sizes(e, {32, 128, 128, 128, 2});
  const double last = test::setting(
      e, "last_matrix", "last weight matrix (?:multiplied by|times)", 0.05);
  for (const bool fixed : {false, true}) {
    Bench<T> b(mlp({.hidden = {sizes.begin() + 1, sizes.end() - 1},
                    .frequencies = sizes.front() / 8}),
               4,
               2);
    const auto& tensors = b.net->tensors();
    test::formula_weights<T>(tensors,
                             test::numbers_in_order(tensors.size()),
                             test::formula_shift("jpo-billiards", e),
                             last,
                             b.p);
    const Batch<T> out = b.forward(in, {.fixed_input = fixed});
    EXPECT_TRUE(
        test::Comparator(rtol, 0)(out, batch<double>(step["net_output"])));
    const Vector<T> bar =
        b.parameters_bar(batch<T>(step["grad_clipped"], 2, in.cols()));
    const Vector<double> norms =
        test::vector(step["weight_grad_norm_per_tensor"]);
    const Json first = step["weight_grad_first_entries"];
    ASSERT_EQ(norms.size(), static_cast<Index>(tensors.size()));
    for (std::size_t t = 0; t < tensors.size(); ++t) {
      const TensorInfo& info = tensors[t];
      const auto part = bar.segment(info.offset, info.size);
      const double norm = part.template cast<double>().norm();
      EXPECT_NEAR(norm, norms(Index(t)), rtol * norms.maxCoeff()) << info.name;
      const Vector<double> stored = test::vector(first.at(t));
      ASSERT_LE(stored.size(), part.size());
      EXPECT_TRUE(
          test::Comparator(0, rtol * norm)(part.head(stored.size()), stored))
          << info.name;
    }
  }
}

TEST(ReferenceTest, Encoding) {
  test::check_entries_named(
      "jpo-billiards",
      "encoding",
      test::in_both(check_encoding<float>, check_encoding<double>));
}

TEST(ReferenceTest, FirstStepOfTheBilliardsNetwork) {
  test::check_entries_named(
      "jpo-billiards",
      "jpo_mlp",
      test::in_both(check_first_step<float>, check_first_step<double>));
}

}  // namespace
}  // namespace physinv::nn
