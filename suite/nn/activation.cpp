#include "suite/nn/activation.h"

#include <algorithm>

namespace physinv::nn {

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

template <class T>
void apply_gate(const Gate<T>& gate, Lanes<T> x_bar) {
  using V = NarrowPack<T>;
  if (gate.activation == Activation::identity) return;
  for (Index i = 0; i < x_bar.rows; ++i) {
    const T* y = gate.y.row(i);
    T* bar = x_bar.row(i);
    for (Index j = 0; j < x_bar.width; j += kNarrowLanes<T>)
      store(bar + j,
            pull_lanes<T>(gate.activation, load<V>(y + j), load<V>(bar + j)));
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
  for (Index i = 0; i < x_bar.rows; ++i)
    for (Index j = 0; j < x_bar.width; j += kNarrowLanes<T>) {
      const V y = load<V>(gate.y.row(i) + j);
      const V bar = load<V>(x_bar.row(i) + j);
      store(x_bar_dot.row(i) + j,
            pull_lanes<T>(a, y, load<V>(x_bar_dot.row(i) + j)) +
                bend_lanes<T>(a, y, bar * load<V>(y_dot.row(i) + j)));
      store(x_bar.row(i) + j, pull_lanes<T>(a, y, bar));
    }
}

template <class T>
void ActivationLayer<T>::forward(const LayerArgs<T>&,
                                 Lanes<const T> x,
                                 Lanes<T> y) const {
  using V = NarrowPack<T>;
  for (Index i = 0; i < x.rows; ++i)
    for (Index j = 0; j < x.width; j += kNarrowLanes<T>)
      store(y.row(i) + j,
            activate_lanes<T>(activation_, load<V>(x.row(i) + j)));
}

template <class T>
void ActivationLayer<T>::backward(const LayerArgs<T>&,
                                  const Backward<T>& b) const {
  using V = NarrowPack<T>;
  if (!b.x_bar) return;
  const Lanes<const T> at = from_output(activation_) ? b.y : b.x;
  for (Index i = 0; i < at.rows; ++i)
    for (Index j = 0; j < at.width; j += kNarrowLanes<T>)
      store(b.x_bar.row(i) + j,
            pull_lanes<T>(activation_,
                          load<V>(at.row(i) + j),
                          load<V>(b.y_bar.row(i) + j)));
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

template void apply_gate<float>(const Gate<float>&, Lanes<float>);
template void apply_gate<double>(const Gate<double>&, Lanes<double>);
template void apply_gate_tangent<float>(const Gate<float>&,
                                        Lanes<const float>,
                                        Lanes<float>,
                                        Lanes<float>);
template void apply_gate_tangent<double>(const Gate<double>&,
                                         Lanes<const double>,
                                         Lanes<double>,
                                         Lanes<double>);
template class ActivationLayer<float>;
template class ActivationLayer<double>;

}  // namespace physinv::nn
