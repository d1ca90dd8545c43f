/// What the options of networks choose from by name.
#pragma once

#include <cstdint>
#include <string_view>

namespace physinv::nn {

enum class Activation : std::uint8_t {
  identity,
  relu,
  tanh,
  sigmoid,
  softplus,
  silu,       ///< z sigma(z)
  half_tanh,  ///< tanh(z / 2) = 2 sigma(z) - 1
  gelu,       ///< z Phi(z), Phi the normal distribution
};
std::string_view to_string(Activation a);

/// How weights are drawn, uniform within +-bound; biases and offsets start at
/// 0, scales at 1. Tensors with a range of their own (TensorInfo) keep it.
enum class Init : std::uint8_t {
  fan_in,   ///< bound 1 / sqrt(fan_in)
  glorot,   ///< bound sqrt(6 / (fan_in + fan_out)), Keras' default
  uniform,  ///< weights and biases as fan_in, PyTorch's default
  he,       ///< bound sqrt(6 / fan_in), for ReLU
};

std::string_view to_string(Init init);

}  // namespace physinv::nn
