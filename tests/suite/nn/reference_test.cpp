// The network's part of the independent vectors of jpo-billiards.

#include "tests/support/reference.h"

#include <gtest/gtest.h>

#include <string>

#include "suite/nn/encoding.h"
#include "suite/nn/mlp.h"
#include "suite/nn/sequential.h"
#include "tests/suite/nn/nn_testing.h"
#include "tests/support/formula_weights.h"

namespace physinv::nn {
namespace {

using test::Json;

Json entry(const std::string& name) {
  return test::reference_entries("jpo-billiards", name).at(0);
}

/// Rows of the file are samples: columns here.
template <class T>
Batch<T> batch(const Json& rows) {
  Batch<T> b(static_cast<Index>(rows.at(0).size()),
             static_cast<Index>(rows.size()));
  for (Index j = 0; j < b.cols(); ++j)
    for (Index i = 0; i < b.rows(); ++i)
      b(i, j) = static_cast<T>(
          rows.at(std::size_t(j)).at(std::size_t(i)).get<double>());
  return b;
}

template <class T>
class ReferenceTest : public testing::Test {};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(ReferenceTest, Types);

TYPED_TEST(ReferenceTest, Encoding) {
  using T = TypeParam;
  const Json e = entry("encoding");
  const Batch<T> in = batch<T>(e["input"]);
  const Batch<double> expected = batch<double>(e["output"]);
  typename Sequential<T>::Layers layers;
  layers.push_back(std::make_unique<PositionalEncoding<T>>(4, 4));
  const Sequential<T> net(std::move(layers));
  Batch<T> out(32, in.cols());
  Vector<T> none(0);
  Tape tape;
  Workspace work;
  net.forward(none, none, in, out, tape, work);
  // Rounding the input to float already moves sin(4a).
  const double tol = sizeof(T) == 4 ? 1e-6 : e["atol"].get<double>();
  EXPECT_LE((out.template cast<double>() - expected).cwiseAbs().maxCoeff(),
            tol);
}

TYPED_TEST(ReferenceTest, FirstStepOfTheBilliardsNetwork) {
  using T = TypeParam;
  const Json e = entry("jpo_mlp"), step = e["steps"][0];
  const double rtol = sizeof(T) == 4 ? 1e-4 : e["rtol"].get<double>();
  Batch<T> in(4, static_cast<Index>(e["balls"].size()));
  in.topRows(2) = batch<T>(e["balls"]);
  in.row(2).setConstant(T(2));
  in.row(3).setConstant(T(0.5));
  for (const bool fixed : {false, true}) {
    Bench<T> b(mlp({.hidden = {128, 128, 128}, .frequencies = 4}), 4, 2);
    const auto& tensors = b.net->tensors();
    test::formula_weights<T>(tensors,
                             test::numbers_in_order(tensors.size()),
                             e["shift"].get<double>(),
                             0.05,
                             b.p);
    const Batch<double> expected = batch<double>(step["net_output"]);
    const Batch<T> out = b.forward(in, {.fixed_input = fixed});
    EXPECT_LE((out.template cast<double>() - expected).cwiseAbs().maxCoeff(),
              rtol * expected.cwiseAbs().maxCoeff());
    const Vector<T> bar = b.parameters_bar(batch<T>(step["grad_clipped"]));
    const Json &norms = step["weight_grad_norm_per_tensor"],
               &first = step["weight_grad_first_entries"];
    double largest = 0;
    for (const Json& n : norms) largest = std::max(largest, n.get<double>());
    for (std::size_t t = 0; t < norms.size(); ++t) {
      const TensorInfo& info = b.net->tensors()[t];
      const auto part = bar.segment(info.offset, info.size);
      const double norm = part.template cast<double>().norm();
      EXPECT_NEAR(norm, norms[t].get<double>(), rtol * largest) << info.name;
      for (std::size_t k = 0; k < first[t].size(); ++k)
        EXPECT_NEAR(part(Index(k)), first[t][k].get<double>(), rtol * norm)
            << info.name << " " << k;
    }
  }
}

}  // namespace
}  // namespace physinv::nn
