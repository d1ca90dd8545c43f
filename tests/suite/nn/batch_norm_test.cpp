#include "suite/nn/batch_norm.h"

#include <gtest/gtest.h>

#include "suite/core/check.h"
#include "tests/suite/nn/nn_testing.h"

namespace physinv::nn {
namespace {

NetworkRecipe only_batch_norm(Index features) {
  return network([=]<class U>() { return layers(batch_norm<U>(features)); });
}

template <class T>
class BatchNormTest : public testing::Test {
 protected:
  const double tol_ = sizeof(T) == 4 ? 1e-5 : 1e-12;
};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(BatchNormTest, Types);

TYPED_TEST(BatchNormTest, FollowsTheFormulas) {
  using T = TypeParam;
  const Index features = 5, n = 11;
  Bench<T> b(only_batch_norm(features), 0, 0);
  Batch<T> in = wavy<T>(features, n);
  in.row(2).array() += T(3);
  const Batch<T> fresh = b.forward(in);
  for (Index i = 0; i < features; ++i)
    EXPECT_NEAR(fresh(i, 0),
                b.p(i) * in(i, 0) / std::sqrt(1 + 1e-5) + b.p(features + i),
                this->tol_ * 4);

  Vector<double> mean = Vector<double>::Zero(features);
  Vector<double> variance = Vector<double>::Ones(features);
  for (int round = 0; round < 3; ++round) {
    const Batch<T> out = b.forward(in, {.training = true});
    b.net->update_state(b.tape, b.s);
    for (Index i = 0; i < features; ++i) {
      double m = 0, v = 0;
      for (Index j = 0; j < n; ++j) m += double(in(i, j)) / double(n);
      for (Index j = 0; j < n; ++j) v += std::pow(double(in(i, j)) - m, 2);
      for (Index j = 0; j < n; ++j)
        EXPECT_NEAR(out(i, j),
                    b.p(i) * (in(i, j) - m) / std::sqrt(v / n + 1e-5) +
                        b.p(features + i),
                    this->tol_);
      mean(i) = 0.9 * mean(i) + 0.1 * m;
      variance(i) = 0.9 * variance(i) + 0.1 * v / double(n - 1);
      EXPECT_NEAR(b.s(i), mean(i), this->tol_);
      EXPECT_NEAR(b.s(features + i), variance(i), this->tol_);
    }
    in.array() *= T(1.5);
  }
}

TYPED_TEST(BatchNormTest, OneSampleHasNoStatistics) {
  using T = TypeParam;
  Bench<T> b(only_batch_norm(3), 0, 0);
  EXPECT_THROW(b.forward(wavy<T>(3, 1), {.training = true}), ContractError);
  b.forward(wavy<T>(3, 1));
  EXPECT_THROW(b.net->update_state(b.tape, b.s), ContractError);
}

}  // namespace
}  // namespace physinv::nn
