// Gradients and shapes of whole networks.

#include <gtest/gtest.h>

#include "suite/nn/mlp.h"
#include "tests/suite/nn/nn_testing.h"

namespace physinv::nn {
namespace {

struct Case {
  const char* name;
  MlpOptions options;
  bool training;
  bool fixed;
};

class NetworkGradient : public testing::TestWithParam<Case> {
 protected:
  NetworkGradient()
      : bench_(mlp(GetParam().options), 3, 2), in_(wavy<double>(3, 7)) {
    in_.row(0).setConstant(0.4);
    in_.row(2).setConstant(-1.2);
    pass_.training = GetParam().training, pass_.fixed_input = GetParam().fixed;
  }
  /// <out_bar, N(p, in)>
  double value(const Batch<double>& in) {
    return (bench_.forward(in, pass_).array() * out_bar_.array()).sum();
  }

  Bench<double> bench_;
  Batch<double> in_, out_bar_ = wavy<double>(2, 7, 2.0);
  Pass pass_;
};

constexpr double kStep = 1e-5;

TEST_P(NetworkGradient, Parameters) {
  value(in_);
  const Vector<double> bar = bench_.parameters_bar(out_bar_);
  Vector<double> slope(bar.size());
  for (Index i = 0; i < bar.size(); ++i) {
    const double p = bench_.p(i);
    bench_.p(i) = p + kStep;
    const double up = value(in_);
    bench_.p(i) = p - kStep;
    slope(i) = (up - value(in_)) / (2 * kStep);
    bench_.p(i) = p;
  }
  EXPECT_LE((bar - slope).cwiseAbs().maxCoeff(),
            1e-7 * bar.cwiseAbs().maxCoeff());
}

TEST_P(NetworkGradient, Input) {
  value(in_);
  const Batch<double> bar = bench_.in_bar(out_bar_);
  Batch<double> slope(bar.rows(), bar.cols());
  // Moving one sample breaks the promise of constant rows, not the values.
  for (Index i = 0; i < bar.size(); ++i) {
    Batch<double> in = in_;
    in(i) += kStep;
    const double up = value(in);
    in(i) = in_(i) - kStep;
    slope(i) = (up - value(in)) / (2 * kStep);
  }
  EXPECT_LE((bar - slope).cwiseAbs().maxCoeff(),
            1e-7 * bar.cwiseAbs().maxCoeff());
}

TEST_P(NetworkGradient, PairsWithTheDirectionalDerivative) {
  const Batch<double> x_dot = wavy<double>(3, 7, 5.0);
  const Vector<double> p_dot = wavy<double>(bench_.p.size(), 1, 6.0);
  value(in_);
  Vector<double> p_bar(bench_.p.size());
  Batch<double> x_bar(3, 7);
  VectorOut<double> p_ref(p_bar);
  BatchOut<double> x_ref(x_bar);
  bench_.net->backward(
      bench_.p, bench_.tape, out_bar_, &p_ref, &x_ref, bench_.work);
  const double pulled =
      p_bar.dot(p_dot) + (x_bar.array() * x_dot.array()).sum();
  const Vector<double> p = bench_.p;
  const double h = 1e-6;
  bench_.p = p + h * p_dot;
  const double up = value(in_ + h * x_dot);
  bench_.p = p - h * p_dot;
  const double pushed = (up - value(in_ - h * x_dot)) / (2 * h);
  EXPECT_NEAR(pulled, pushed, 1e-7 * std::abs(pushed));
}

const Case kCases[] = {
    {"relu", {.hidden = {9, 6}}, false, false},
    {"encoded", {.hidden = {9, 6}, .frequencies = 3}, false, false},
    {"folded", {.hidden = {9, 6}, .frequencies = 3}, false, true},
    {"tanh", {.hidden = {9, 6}, .activation = Activation::tanh}, false, true},
    {"sigmoid",
     {.hidden = {9, 6}, .activation = Activation::sigmoid},
     false,
     false},
    {"softplus",
     {.hidden = {9, 6},
      .activation = Activation::softplus,
      .output = Activation::softplus},
     false,
     false},
    {"silu",
     {.hidden = {9, 6},
      .activation = Activation::silu,
      .output = Activation::silu},
     false,
     false},
    {"gelu",
     {.hidden = {9, 6},
      .activation = Activation::gelu,
      .output = Activation::gelu},
     false,
     false},
    {"norm_training",
     {.hidden = {9, 6}, .activation = Activation::tanh, .batch_norm = true},
     true,
     false},
    {"norm_eval",
     {.hidden = {9, 6}, .frequencies = 2, .batch_norm = true},
     false,
     true},
    {"linear", {}, false, false},
};
INSTANTIATE_TEST_SUITE_P(All,
                         NetworkGradient,
                         testing::ValuesIn(kCases),
                         [](const auto& c) {
                           return std::string(c.param.name);
                         });

TEST(Mlp, CountsAndTensors) {
  const NetworkRecipe recipe =
      mlp({.hidden = {128, 128, 128}, .frequencies = 4});
  const auto net = recipe.make<float>(4, 2);
  EXPECT_EQ(net->parameter_count(), 37506);
  EXPECT_EQ(net->state_count(), 0);
  ASSERT_EQ(net->tensors().size(), 8U);
  EXPECT_EQ(net->tensors()[0].name, "m1");
  EXPECT_EQ(net->tensors()[0].size, 32 * 128);
  EXPECT_EQ(net->tensors()[0].fan_in, 32);
  EXPECT_EQ(net->tensors()[7].name, "b4");
  EXPECT_EQ(net->tensors()[7].offset, 37504);
  EXPECT_FALSE(recipe.description.empty());

  const auto norm = mlp({.hidden = {5}, .batch_norm = true}).make<double>(3, 2);
  EXPECT_EQ(norm->parameter_count(), 3 * 5 + 5 + 5 + 5 + 5 * 2 + 2);
  EXPECT_EQ(norm->state_count(), 10);
  EXPECT_EQ(norm->tensors()[2].name, "s1");
  EXPECT_EQ(norm->tensors()[3].name, "o1");
}

TEST(Mlp, InitialWeights) {
  const auto net = mlp({.hidden = {40}, .batch_norm = true}).make<double>(9, 2);
  const auto more = mlp({.hidden = {40, 7}}).make<double>(9, 2);
  Vector<double> p(net->parameter_count()), s(net->state_count());
  Vector<double> q(more->parameter_count()), none(0);
  net->initialize(Rng::root("init", 3), p, s);
  more->initialize(Rng::root("init", 3), q, none);
  const auto m1 = p.head(360).array();
  EXPECT_LE(m1.abs().maxCoeff(), 1.0 / 3);
  EXPECT_GE(m1.abs().maxCoeff(), 0.3);
  EXPECT_NEAR(m1.square().mean(), 1.0 / 27, 0.01);
  EXPECT_TRUE((m1 == q.head(360).array()).all());  // whatever follows
  EXPECT_TRUE((p.segment(360, 40).array() == 0).all());
  EXPECT_TRUE((p.segment(400, 40).array() == 1).all());
  EXPECT_TRUE((p.segment(440, 40).array() == 0).all());
  EXPECT_TRUE((s.head(40).array() == 0).all());
  EXPECT_TRUE((s.tail(40).array() == 1).all());
}

}  // namespace
}  // namespace physinv::nn
