#include "suite/nn/activation.h"

#include <gtest/gtest.h>

#include <limits>

namespace physinv::nn {
namespace {

constexpr Activation kAll[] = {Activation::identity,
                               Activation::relu,
                               Activation::tanh,
                               Activation::sigmoid,
                               Activation::softplus,
                               Activation::silu,
                               Activation::half_tanh,
                               Activation::gelu};

TEST(Activation, DerivativeAgainstCentralDifferences) {
  for (const Activation a : kAll) {
    for (const double z : {-3.1, -0.7, 0.2, 1.9, 6.0}) {
      const double h = 1e-5;
      const double slope = (activate(a, z + h) - activate(a, z - h)) / (2 * h);
      const double at = from_output(a) ? activate(a, z) : z;
      EXPECT_NEAR(derivative(a, at), slope, 1e-9) << to_string(a) << " " << z;
    }
  }
}

TEST(Activation, SecondDerivativeIsThatOfTheDerivative) {
  for (const Activation a : kAll) {
    if (a == Activation::relu) continue;  // y = 0 is a kink
    for (const double z : {-3.1, -0.7, 0.2, 1.9, 6.0}) {
      const double h = 1e-5, y = from_output(a) ? activate(a, z) : z;
      const double slope = (derivative(a, y + h) - derivative(a, y - h)) / 2;
      EXPECT_NEAR(second_derivative(a, y), slope / h, 1e-8)
          << to_string(a) << " " << z;
    }
  }
}

TEST(Activation, HalfTanhIsASigmoid) {
  for (const double z : {-30.0, -2.0, 0.0, 0.3, 5.0})
    EXPECT_NEAR(activate(Activation::half_tanh, z), 2 * sigmoid(z) - 1, 1e-15);
}

TEST(Activation, FarOutStaysFinite) {
  for (const Activation a : kAll) {
    for (const float z : {-1e3F, 1e3F}) {
      const float y = activate(a, z);
      EXPECT_TRUE(std::isfinite(y)) << to_string(a);
      EXPECT_TRUE(std::isfinite(derivative(a, from_output(a) ? y : z)));
    }
  }
}

TEST(Activation, KeepsNaN) {
  for (const Activation a : kAll)
    EXPECT_TRUE(
        std::isnan(activate(a, std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace physinv::nn
