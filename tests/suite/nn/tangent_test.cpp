// Forward mode and products with the Hessian, of networks of every kind of
// layer: against central differences, against `backward`, against themselves.

#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "suite/core/threads.h"
#include "suite/nn/activation.h"
#include "suite/nn/cnn.h"
#include "suite/nn/conv.h"
#include "suite/nn/fno.h"
#include "suite/nn/mlp.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"
#include "tests/suite/nn/nn_testing.h"

namespace physinv::nn {
namespace {

struct Built {
  const char* name;
  NetworkRecipe recipe;
  Index inputs, outputs;
};

/// A pooled block on a plane whose pooling has an activation with a bend, and
/// an activation of its own behind a convolution.
NetworkRecipe bent() {
  return network([]<class T>() {
    return layers(conv_block<T>({.grid = {6, 4},
                                 .in = 2,
                                 .out = 3,
                                 .taps = {3, 3},
                                 .padding = Padding::circular},
                                Activation::tanh,
                                true),
                  conv<T>({.grid = {3, 2}, .in = 3, .out = 2, .taps = {3, 3}}),
                  activation_layer<T>(Activation::sigmoid, 12),
                  conv<T>({.grid = {3, 2}, .in = 2, .out = 1, .taps = {1, 1}}),
                  activation_layer<T>(Activation::silu, 6));
  });
}

std::vector<Built> networks() {
  const auto dense = [](Activation a, bool norm) {
    return mlp({.hidden = {7, 5}, .activation = a, .batch_norm = norm});
  };
  return {
      {"relu", dense(Activation::relu, true), 4, 3},
      {"tanh", dense(Activation::tanh, false), 4, 3},
      {"sigmoid", dense(Activation::sigmoid, true), 4, 3},
      {"softplus", dense(Activation::softplus, false), 4, 3},
      {"silu", dense(Activation::silu, true), 4, 3},
      {"gelu", dense(Activation::gelu, false), 4, 3},
      {"half_tanh", dense(Activation::half_tanh, false), 4, 3},
      {"encoded",
       mlp({.hidden = {6}, .frequencies = 3, .activation = Activation::tanh}),
       2,
       2},
      {"bent", bent(), 48, 6},
      {"vgg",
       vgg({.channels = 2, .grid = {16}, .features = {4, 5}, .hidden = {6}}),
       32,
       2},
      {"plane_vgg",
       vgg({.channels = 2, .grid = {8, 4}, .features = {3}, .hidden = {7}}),
       64,
       3},
      {"unet",
       unet({.grid = {16}, .scalars_before = 1, .features = 3}),
       17,
       16},
      {"plane_unet",
       unet({.grid = {9, 12},
             .levels = 3,
             .features = 4,
             .outputs = 2,
             .padding = Padding::circular,
             .batch_statistics = true,
             .init = Init::uniform}),
       108,
       216},
      {"operator",
       fno({.grid = {6, 5},
            .padding = 2,
            .modes = 3,
            .width = 3,
            .blocks = 2,
            .hidden = 5}),
       30,
       30},
      {"cnn", cnn({.positions = 8, .channels = 2, .features = {5, 4}}), 16, 8},
  };
}

template <class T>
struct Moved : Bench<T> {
  Moved(const Built& built, bool training, Threads* threads = nullptr)
      : Bench<T>(built.recipe, built.inputs, built.outputs, threads),
        pass{.training = training},
        in(wavy<T>(built.inputs, kSamples)),
        out(this->forward(in, pass)),
        out_bar(wavy<T>(out.rows(), kSamples, 1)),
        out_bar_dot(wavy<T>(out.rows(), kSamples, 2)),
        p_dot(wavy<T>(this->p.size(), 1, 3)),
        in_dot(wavy<T>(built.inputs, kSamples, 4)) {}

  Batch<T> tangent(const Vector<T>& direction, const Batch<T>& in_direction) {
    Batch<T> out_dot(out.rows(), kSamples);
    this->net->tangent(this->p,
                       this->tape,
                       direction,
                       in_direction,
                       out_dot,
                       dots,
                       this->work);
    return out_dot;
  }
  Batch<T> tangent(const Vector<T>& direction) {
    return tangent(direction, Batch<T>(in.rows(), 0));
  }
  /// Of the last tangent's direction.
  Vector<T> product(const Vector<T>& direction,
                    const Batch<T>& bar,
                    const Batch<T>& bar_dot,
                    Vector<T>* gradient = nullptr) {
    Vector<T> all = Vector<T>::Constant(direction.size(), std::nan(""));
    Vector<T> first = all;
    VectorOut<T> ref(first);
    this->net->backward_tangent(this->p,
                                this->tape,
                                direction,
                                dots,
                                bar,
                                bar_dot,
                                gradient != nullptr ? &ref : nullptr,
                                all,
                                this->work);
    if (gradient != nullptr) *gradient = first;
    return all;
  }

  static constexpr Index kSamples = 6;
  Pass pass;
  Batch<T> in, out, out_bar, out_bar_dot;
  Vector<T> p_dot;
  Batch<T> in_dot;
  Tape dots;
};

class TangentTest : public testing::TestWithParam<std::tuple<Built, bool>> {
 protected:
  template <class T>
  Moved<T> moved() const {
    const auto& [built, training] = GetParam();
    return {built, training};
  }
};

/// Norm of the difference as part of the norm.
template <class M>
double apart(const M& a, const M& b) {
  return double((a - b).norm()) / double(b.norm());
}

template <class T>
double digits() {
  return std::is_same_v<T, float> ? 3e-4 : 1e-11;
}

TEST_P(TangentTest, AgreesWithCentralDifferences) {
  auto b = moved<double>();
  const Batch<double> out_dot = b.tangent(b.p_dot, b.in_dot);
  const Vector<double> p = b.p;
  const double h = 1e-6;
  const auto at = [&](double step) {
    b.p = p + step * b.p_dot;
    return b.forward(b.in + step * b.in_dot, b.pass);
  };
  const Batch<double> slope = (at(h) - at(-h)) / (2 * h);
  EXPECT_LT(apart(out_dot, slope), 1e-7);
}

TEST_P(TangentTest, ProductAgreesWithDifferencesOfGradients) {
  auto b = moved<double>();
  b.tangent(b.p_dot);
  const Vector<double> product = b.product(b.p_dot, b.out_bar, b.out_bar_dot);
  const Vector<double> p = b.p;
  // Small, as a gradient jumps where a ReLU opens.
  const double h = 1e-7;
  const auto at = [&](double step) {
    b.p = p + step * b.p_dot;
    b.forward(b.in, b.pass);
    return b.parameters_bar(b.out_bar + step * b.out_bar_dot);
  };
  const Vector<double> slope = (at(h) - at(-h)) / (2 * h);
  EXPECT_LT(apart(product, slope), 1e-6);
}

template <class T>
void expect_transposed(Moved<T> b) {
  const Batch<T> out_dot = b.tangent(b.p_dot, b.in_dot);
  const double pushed = (out_dot.template cast<double>().array() *
                         b.out_bar.template cast<double>().array())
                            .sum();
  const Vector<T> p_bar = b.parameters_bar(b.out_bar);
  const Batch<T> in_bar = b.in_bar(b.out_bar);
  const double pulled =
      p_bar.template cast<double>().dot(b.p_dot.template cast<double>()) +
      (in_bar.template cast<double>().array() *
       b.in_dot.template cast<double>().array())
          .sum();
  EXPECT_NEAR(
      pushed, pulled, digits<T>() * double(out_dot.norm() * b.out_bar.norm()));
}

TEST_P(TangentTest, IsTheTransposeOfBackward) {
  expect_transposed(moved<float>());
  expect_transposed(moved<double>());
}

/// H = d^2/dp^2 of half the square of the output.
template <class T>
void expect_symmetric(Moved<T> b) {
  const Vector<T> u = b.p_dot, v = wavy<T>(u.size(), 1, 5);
  Vector<T> gradient;
  const Batch<T> u_dot = b.tangent(u);
  const Vector<T> hu = b.product(u, b.out, u_dot, &gradient);
  const Batch<T> v_dot = b.tangent(v);
  const Vector<T> hv = b.product(v, b.out, v_dot);
  EXPECT_NEAR(double(u.dot(hv)),
              double(v.dot(hu)),
              digits<T>() * double(u.norm() * hv.norm()));
  EXPECT_LT(apart(gradient, b.parameters_bar(b.out)), digits<T>());
  // The tapes serve any number of directions.
  expect_same_bits(b.tangent(u), u_dot);
  expect_same_bits(b.product(u, b.out, u_dot), hu);
}

TEST_P(TangentTest, HessianIsSymmetric) {
  expect_symmetric(moved<float>());
  expect_symmetric(moved<double>());
}

TEST_P(TangentTest, FloatAgreesWithDouble) {
  auto f = moved<float>();
  auto d = moved<double>();
  // The same point and direction in both.
  d.p = f.p.cast<double>(), d.p_dot = f.p_dot.cast<double>();
  d.in = f.in.cast<double>(), d.out_bar = f.out_bar.cast<double>();
  d.out_bar_dot = f.out_bar_dot.cast<double>();
  d.forward(d.in, d.pass);
  EXPECT_LT(apart(Batch<double>(f.tangent(f.p_dot).cast<double>()),
                  d.tangent(d.p_dot)),
            1e-4);
  EXPECT_LT(
      apart(Vector<double>(
                f.product(f.p_dot, f.out_bar, f.out_bar_dot).cast<double>()),
            d.product(d.p_dot, d.out_bar, d.out_bar_dot)),
      1e-3);
}

// Enough work for blocks, parts and threads.
TEST(Tangent, BitsDoNotDependOnThreads) {
  const std::vector<Built> planes = {
      {"plane_unet",
       unet({.grid = {32, 32},
             .levels = 2,
             .padding = Padding::circular,
             .batch_statistics = true}),
       1024,
       1024},
      {"plane_operator",
       fno({.grid = {32, 32}, .width = 8, .blocks = 2}),
       1024,
       1024}};
  Threads threads(3);
  for (const Built& plane : planes) {
    Moved<float> one(plane, true), three(plane, true, &threads);
    const Batch<float> out_dot = one.tangent(one.p_dot);
    expect_same_bits(three.tangent(three.p_dot), out_dot);
    expect_same_bits(three.product(three.p_dot, three.out_bar, out_dot),
                     one.product(one.p_dot, one.out_bar, out_dot));
  }
}

INSTANTIATE_TEST_SUITE_P(Networks,
                         TangentTest,
                         testing::Combine(testing::ValuesIn(networks()),
                                          testing::Bool()),
                         [](const auto& at) {
                           return std::string(std::get<0>(at.param).name) +
                                  (std::get<1>(at.param) ? "_training"
                                                         : "_evaluation");
                         });

}  // namespace
}  // namespace physinv::nn
