#include "optimizers/network_model.h"

#include <gtest/gtest.h>

#include "suite/nn/mlp.h"
#include "tests/support/bits.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Shape kShape{.unknowns = 2, .observations = 3, .given = 1};

Batch<double> filled(Index rows, Index cols, double shift) {
  return Batch<double>::NullaryExpr(rows, cols, [=](Index i, Index j) {
    return std::sin(1.7 * double(i) + 0.6 * double(j) + shift);
  });
}

NetworkRole role(bool batch_norm = true) {
  return {{Field::given, Field::observations},
          nn::mlp({.hidden = {8}, .frequencies = 2, .batch_norm = batch_norm})};
}

template <class T>
class NetworkModelTest : public testing::Test {};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(NetworkModelTest, Types);

TEST(Assemble, StacksFieldsInTheListedOrder) {
  const auto x = filled(2, 5, 0), given = filled(1, 5, 1), y = filled(3, 5, 2);
  const std::vector<Field> all = {
      Field::observations, Field::unknowns, Field::given};
  const Batch<double> input = assemble<double>(all, x, given, y);
  ASSERT_EQ(input.rows(), 6);
  EXPECT_EQ(input.topRows(3), y);
  EXPECT_EQ(input.middleRows(3, 2), x);
  EXPECT_EQ(input.bottomRows(1), given);
  EXPECT_EQ(input_rows(all, kShape), 6);
  EXPECT_EQ(input_rows({Field::given}, kShape), 1);
  const Batch<float> rounded = assemble<float>(all, x, given, y);
  EXPECT_EQ(rounded, input.cast<float>());
}

TYPED_TEST(NetworkModelTest, WarmingUpLeavesNothingBehind) {
  using T = TypeParam;
  NetworkModel<T> cold(role(), kShape, 2, nullptr);
  NetworkModel<T> warm(role(), kShape, 2, nullptr);
  for (auto* m : {&cold, &warm}) {
    m->initialize(Rng::root("network_model", 1));
    m->bind(filled(4, 9, 0).template cast<T>());
  }
  warm.warm_up();
  EXPECT_EQ(warm.counts(), Counts{});
  EXPECT_TRUE(same_bits(warm.state(), cold.state()));
  for (int i = 0; i < 2; ++i) {
    const Batch<T> out = cold.forward();
    EXPECT_TRUE(same_bits(warm.forward(), out));
    EXPECT_TRUE(same_bits(warm.backward(out), cold.backward(out)));
    cold.update_state(), warm.update_state();
    EXPECT_TRUE(same_bits(warm.state(), cold.state()));
  }
  EXPECT_EQ(warm.counts(), cold.counts());
  EXPECT_GT(warm.counts()[Counter::network_forward], 0U);
  const std::size_t bytes = warm.bytes();
  warm.forward();
  EXPECT_EQ(warm.bytes(), bytes);
}

TYPED_TEST(NetworkModelTest, SavedAndLoadedItPredictsTheSame) {
  using T = TypeParam;
  NetworkModel<T> first(role(), kShape, 2, nullptr);
  NetworkModel<T> second(role(), kShape, 2, nullptr);
  first.initialize(Rng::root("network_model", 1));
  first.bind(filled(4, 9, 0).template cast<T>());
  first.forward();
  first.update_state();
  Arrays arrays;
  first.save(arrays);
  ASSERT_TRUE(arrays.contains("state"));
  second.load(arrays);
  const Batch<T> input = filled(4, 5, 3).template cast<T>();
  Batch<T> a(2, 5), b(2, 5);
  const Counts before = first.counts();
  first.predict(input, a);
  second.predict(input, b);
  EXPECT_TRUE(same_bits(a, b));
  EXPECT_EQ(first.counts(), before) << "predictions are not counted";

  NetworkModel<T> plain(role(false), kShape, 2, nullptr);
  EXPECT_THROW(plain.load(arrays), ContractError);
}

// Between updates, predictions use the memory of the last minibatch.
TYPED_TEST(NetworkModelTest, PredictionsBetweenMinibatchesChangeNothing) {
  using T = TypeParam;
  NetworkModel<T> model(role(), kShape, 2, nullptr);
  NetworkModel<T> other(role(), kShape, 2, nullptr);
  for (NetworkModel<T>* m : {&model, &other})
    m->initialize(Rng::root("network_model", 1));
  for (int k = 0; k < 3; ++k) {
    for (const Index count : {5, 9, 12}) {  // fewer, as many, more
      const Batch<T> input = filled(4, count, 3).template cast<T>();
      Batch<T> out(2, count), expected(2, count);
      NetworkModel<T> alone(role(), kShape, 2, nullptr);
      Arrays arrays;
      model.save(arrays);
      alone.load(arrays);
      model.predict(input, out), alone.predict(input, expected);
      EXPECT_TRUE(same_bits(out, expected)) << count;
    }
    const Batch<T> batch = filled(4, 9, k).template cast<T>();
    const Batch<T> out_bar = filled(2, 9, k + 1).template cast<T>();
    EXPECT_TRUE(same_bits(model.forward(batch), other.forward(batch)));
    EXPECT_TRUE(same_bits(model.backward(out_bar), other.backward(out_bar)));
    model.update_state(), other.update_state();
  }
  EXPECT_EQ(model.counts(), other.counts());
  EXPECT_EQ(model.bytes(), other.bytes()) << "no memory beside training's";
}

// Training uses the statistics of the batch, prediction the running ones.
TYPED_TEST(NetworkModelTest, TrainsAndPredictsInDifferentModes) {
  using T = TypeParam;
  NetworkModel<T> model(role(), kShape, 2, nullptr);
  model.initialize(Rng::root("network_model", 1));
  const Batch<T> input = filled(4, 9, 0).template cast<T>();
  model.bind(input);
  const Batch<T> training = model.forward();
  Batch<T> out(2, 9);
  model.predict(input, out);
  EXPECT_GT((training - out).norm(), T(1e-3));
  for (int i = 0; i < 300; ++i) model.forward(), model.update_state();
  model.predict(input, out);  // variances differ by n / (n - 1)
  EXPECT_TRUE(Comparator(0.2, 0)(out, training));
}

TYPED_TEST(NetworkModelTest, ChangePerTensorIsTheMeanAbsoluteChange) {
  using T = TypeParam;
  NetworkModel<T> model(role(), kShape, 2, nullptr);
  const Rng start = Rng::root("network_model", 1);
  model.initialize(start);
  EXPECT_EQ(model.change_per_tensor(start).cwiseAbs().maxCoeff(), 0);
  const auto& tensors = model.network().tensors();
  for (std::size_t t = 0; t < tensors.size(); ++t) {
    auto part = model.parameters().segment(tensors[t].offset, tensors[t].size);
    for (Index k = 0; k < part.size(); ++k)
      part(k) += static_cast<T>((k % 2 == 0 ? 1 : -1) * double(t + 1));
  }
  const Batch<double> change = model.change_per_tensor(start);
  for (Index t = 0; t < change.rows(); ++t)
    EXPECT_NEAR(change(t, 0), double(t + 1), 1e-5);
}

TYPED_TEST(NetworkModelTest, GradientsAreThoseOfTheNetwork) {
  using T = TypeParam;
  NetworkModel<T> model(role(false), kShape, 2, nullptr);
  model.initialize(Rng::root("network_model", 1));
  const Batch<T> input = filled(4, 9, 0).template cast<T>();
  const Batch<T> out_bar = filled(2, 9, 5).template cast<T>();
  model.bind(input);
  Batch<T> out(2, 9);
  Vector<T> bar(model.network().parameter_count());
  VectorOut<T> ref(bar);
  Tape tape;
  Workspace work;
  const auto& net = model.network();
  net.forward(model.parameters(), model.state(), input, out, tape, work);
  net.backward(model.parameters(), tape, out_bar, &ref, nullptr, work);
  const Comparator same(sizeof(T) == 4 ? 1e-5 : 1e-13, 0);
  EXPECT_TRUE(same(model.forward(), out));
  EXPECT_TRUE(same(model.backward(out_bar), bar));
}

}  // namespace
}  // namespace physinv::test
