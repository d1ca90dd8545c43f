#include "suite/nn/activation.h"

#include <algorithm>
#include <type_traits>

namespace physinv::nn {
namespace {

/// Calls f(offset) for every vector of rows [first, last).
template <class T, class F>
void each_vector(Lanes<T> x, Index first, Index last, F&& f) {
  constexpr Index w = kNarrowLanes<std::remove_const_t<T>>;
  const Index end = last * x.stride;
  if (x.width == x.stride) {
    for (Index k = first * x.stride; k < end; k += w) f(k);
  } else {
    for (Index row = first * x.stride; row < end; row += x.stride)
      for (Index j = 0; j < x.width; j += w) f(row + j);
  }
}

}  // namespace

std::string_view to_string(Activation a) {
  constexpr std::string_view names[] = {"identity",
                                        "relu",
                                        "tanh",
                                        "sigmoid",
                                        "softplus",
                                        "silu",
                                        "half_tanh",
                                        "gelu"};
  return names[static_cast<std::size_t>(a)];
}

// A loop of its own for ReLU: it costs less than to ask at each vector.

template <class T>
void activate_rows(Activation a, Lanes<T> z, Index first, Index last) {
  using V = NarrowPack<T>;
  const auto all = [&](auto&& f) {
    each_vector(z, first, last, [&](Index k) {
      store(z.data + k, f(load<V>(z.data + k)));
    });
  };
  if (a == Activation::identity) return;
  if (a == Activation::relu) {
    all([](V v) { return relu_lanes(v); });
  } else {
    all([a](V v) { return activate_lanes<T>(a, v); });
  }
}

template <class T>
void apply_gate(const Gate<T>& gate, Lanes<T> x_bar) {
  using V = NarrowPack<T>;
  const Activation a = gate.activation;
  const auto all = [&](auto&& f) {
    each_vector(x_bar, 0, x_bar.rows, [&](Index k) {
      T* const bar = x_bar.data + k;
      store(bar, f(load<V>(gate.y.data + k), load<V>(bar)));
    });
  };
  if (a == Activation::identity) return;
  if (a == Activation::relu) {
    all([](V y, V bar) { return pull_relu_lanes(y, bar); });
  } else {
    all([a](V y, V bar) { return pull_lanes<T>(a, y, bar); });
  }
}

template <class T>
void apply_gate_tangent(const Gate<T>& gate,
                        Lanes<const T> y_dot,
                        Lanes<T> x_bar,
                        Lanes<T> x_bar_dot) {
  using V = NarrowPack<T>;
  const Activation a = gate.activation;
  if (a == Activation::identity) return;
  each_vector(x_bar, 0, x_bar.rows, [&](Index k) {
    const V y = load<V>(gate.y.data + k), bar = load<V>(x_bar.data + k);
    store(x_bar_dot.data + k,
          pull_lanes<T>(a, y, load<V>(x_bar_dot.data + k)) +
              bend_lanes<T>(a, y, bar * load<V>(y_dot.data + k)));
    store(x_bar.data + k, pull_lanes<T>(a, y, bar));
  });
}

template <class T>
void ActivationLayer<T>::forward(const LayerArgs<T>&,
                                 Lanes<const T> x,
                                 Lanes<T> y) const {
  using V = NarrowPack<T>;
  each_vector(x, 0, x.rows, [&](Index k) {
    store(y.data + k, activate_lanes<T>(activation_, load<V>(x.data + k)));
  });
}

template <class T>
void ActivationLayer<T>::backward(const LayerArgs<T>&,
                                  const Backward<T>& b) const {
  using V = NarrowPack<T>;
  if (!b.x_bar) return;
  const Lanes<const T> at = from_output(activation_) ? b.y : b.x;
  each_vector(at, 0, at.rows, [&](Index k) {
    store(b.x_bar.data + k,
          pull_lanes<T>(
              activation_, load<V>(at.data + k), load<V>(b.y_bar.data + k)));
  });
  apply_gate(b.gate, b.x_bar);
}

template <class T>
void ActivationLayer<T>::tangent(const LayerArgs<T>&,
                                 const Tangent<T>& t) const {
  const Lanes<const T> at = from_output(activation_) ? t.y : t.x;
  std::copy_n(t.x_dot.data, t.y_dot.rows * t.y_dot.stride, t.y_dot.data);
  apply_gate<T>({activation_, at}, t.y_dot);
}

template <class T>
void ActivationLayer<T>::backward_tangent(const LayerArgs<T>&,
                                          const BackwardTangent<T>& b) const {
  if (!b.x_bar) return;
  const Index numbers = b.x_bar.rows * b.x_bar.stride;
  std::copy_n(b.y_bar.data, numbers, b.x_bar.data);
  std::copy_n(b.y_bar_dot.data, numbers, b.x_bar_dot.data);
  const bool out = from_output(activation_);
  apply_gate_tangent<T>({activation_, out ? b.y : b.x},
                        out ? b.y_dot : b.x_dot,
                        b.x_bar,
                        b.x_bar_dot);
}

template decltype(activate_rows<float>) activate_rows<float>;
template decltype(activate_rows<double>) activate_rows<double>;
template decltype(apply_gate<float>) apply_gate<float>;
template decltype(apply_gate<double>) apply_gate<double>;
template decltype(apply_gate_tangent<float>) apply_gate_tangent<float>;
template decltype(apply_gate_tangent<double>) apply_gate_tangent<double>;
template class ActivationLayer<float>;
template class ActivationLayer<double>;

}  // namespace physinv::nn
