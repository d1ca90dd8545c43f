/// Activations and their derivatives.
#pragma once

#include <cmath>
#include <cstdint>

#include "suite/core/math.h"
#include "suite/core/simd/math.h"
#include "suite/core/simd/pack.h"
#include "suite/nn/gelu.h"
#include "suite/nn/layer.h"

namespace physinv::nn {

/// Whether the derivative follows from the output alone, so that an
/// activation fused into the layer before it needs no memory of its own.
constexpr bool from_output(Activation a) {
  return a != Activation::silu && a != Activation::gelu;
}

template <class T>
inline T sigmoid(T z) {
  return T(1) / (T(1) + math::exp(-z));
}

template <class T>
inline T activate(Activation a, T z) {
  switch (a) {
    case Activation::identity:
      return z;
    case Activation::relu:
      return z < T(0) ? T(0) : z;  // keeps NaN
    case Activation::tanh:
      return math::tanh(z);
    case Activation::sigmoid:
      return sigmoid(z);
    case Activation::softplus:
      return (z > T(0) ? z : T(0)) + math::log1p(math::exp(-std::abs(z)));
    case Activation::silu:
      return z * sigmoid(z);
    case Activation::half_tanh:
      return math::tanh(z / T(2));
    case Activation::gelu:
      return z * normal_cdf(z);
  }
  return z;
}

/// Derivative, given the output y (SiLU, GELU: given the input).
template <class T>
inline T derivative(Activation a, T y) {
  switch (a) {
    case Activation::identity:
      return T(1);
    case Activation::relu:
      return y > T(0) ? T(1) : T(0);
    case Activation::tanh:
      return std::fma(-y, y, T(1));
    case Activation::sigmoid:
      return y * (T(1) - y);
    case Activation::softplus:
      return -math::expm1(-y);
    case Activation::silu: {
      const T s = sigmoid(y);
      return s * std::fma(y, T(1) - s, T(1));
    }
    case Activation::half_tanh:
      return std::fma(-y, y, T(1)) / T(2);
    case Activation::gelu:
      return std::fma(y, normal_density(y), normal_cdf(y));
  }
  return T(1);
}

/// Derivative of `derivative` by y.
template <class T>
inline T second_derivative(Activation a, T y) {
  switch (a) {
    case Activation::identity:
    case Activation::relu:
      return T(0);
    case Activation::tanh:
      return T(-2) * y;
    case Activation::half_tanh:
      return -y;
    case Activation::sigmoid:
      return T(1) - T(2) * y;
    case Activation::softplus:
      return math::exp(-y);
    case Activation::silu: {
      const T s = sigmoid(y), slope = s * (T(1) - s);
      return slope * std::fma(y, T(1) - T(2) * s, T(2));
    }
    case Activation::gelu:
      return normal_density(y) * std::fma(-y, y, T(2));
  }
  return T(0);
}

/// A ReLU of a register, and what it lets through of a cotangent.
template <class V>
PHYSINV_LANES V relu_lanes(V z) {
  return z < V{} ? V{} : z;
}
template <class V>
PHYSINV_LANES V pull_relu_lanes(V y, V y_bar) {
  return y > V{} ? y_bar : V{};
}

/// The same for any activation. tanh has an absolute, not a relative, error of
/// about eps.
template <class T, class V>
inline V activate_lanes(Activation a, V z) {
  if (a == Activation::identity) return z;
  if (a == Activation::relu) return relu_lanes(z);
  if (a == Activation::tanh) return tanh_lanes(z);
  if (a == Activation::sigmoid) return sigmoid_lanes(z);
  if (a == Activation::half_tanh) return tanh_lanes(broadcast<V>(T(0.5)) * z);
  if (a == Activation::silu) return z * sigmoid_lanes(z);
  if (a == Activation::gelu) return gelu_lanes(z);
  for (std::size_t l = 0; l < sizeof(V) / sizeof(T); ++l)
    z[l] = activate<T>(a, z[l]);
  return z;
}

/// y_bar times the derivative.
template <class T, class V>
inline V pull_lanes(Activation a, V y, V y_bar) {
  if (a == Activation::identity) return y_bar;
  if (a == Activation::relu) return pull_relu_lanes(y, y_bar);
  if (a == Activation::tanh)
    return y_bar * fma_lanes(-y, y, broadcast<V>(T(1)));
  if (a == Activation::sigmoid) return y_bar * (y * (broadcast<V>(T(1)) - y));
  if (a == Activation::gelu) return y_bar * gelu_slope_lanes(y);
  for (std::size_t l = 0; l < sizeof(V) / sizeof(T); ++l)
    y_bar[l] *= derivative<T>(a, y[l]);
  return y_bar;
}

/// v times the second derivative.
template <class T, class V>
inline V bend_lanes(Activation a, V y, V v) {
  if (a == Activation::identity || a == Activation::relu) return V{};
  for (std::size_t l = 0; l < sizeof(V) / sizeof(T); ++l)
    v[l] *= second_derivative<T>(a, y[l]);
  return v;
}

/// Rows [first, last) of z through the activation, in place.
template <class T>
void activate_rows(Activation a, Rows<T> z, Index first, Index last);

/// x_bar *= derivative at `gate`; what a layer does to its input's cotangent
/// when it has no tile store to fuse it into.
template <class T>
void apply_gate(const Gate<T>& gate, Rows<T> x_bar);

/// The same and its derivative, the gate's y moving along y_dot.
template <class T>
void apply_gate_tangent(const Gate<T>& gate,
                        Rows<const T> y_dot,
                        Rows<T> x_bar,
                        Rows<T> x_bar_dot);

/// An activation on its own: behind a layer that cannot take it in, or one
/// whose derivative needs the input (SiLU, GELU).
template <class T>
LayerPointer<T> activation_layer(Activation a, Index features);

}  // namespace physinv::nn
