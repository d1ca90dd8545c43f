#include "suite/nn/activation.h"

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
  using V = Simd<T, kNarrow>;
  if (gate.activation == Activation::identity) return;
  for (Index i = 0; i < x_bar.rows; ++i) {
    const T* y = gate.y.row(i);
    T* bar = x_bar.row(i);
    for (Index j = 0; j < x_bar.width; j += kLanes<T>)
      store(bar + j,
            pull_lanes<T>(gate.activation, load<V>(y + j), load<V>(bar + j)));
  }
}

template <class T>
void ActivationLayer<T>::forward(const LayerArgs<T>&,
                                 Lanes<const T> x,
                                 Lanes<T> y) const {
  using V = Simd<T, kNarrow>;
  for (Index i = 0; i < x.rows; ++i)
    for (Index j = 0; j < x.width; j += kLanes<T>)
      store(y.row(i) + j,
            activate_lanes<T>(activation_, load<V>(x.row(i) + j)));
}

template <class T>
void ActivationLayer<T>::backward(const LayerArgs<T>&,
                                  const Backward<T>& b) const {
  using V = Simd<T, kNarrow>;
  if (!b.x_bar) return;
  const Lanes<const T> at = from_output(activation_) ? b.y : b.x;
  for (Index i = 0; i < at.rows; ++i)
    for (Index j = 0; j < at.width; j += kLanes<T>)
      store(b.x_bar.row(i) + j,
            pull_lanes<T>(activation_,
                          load<V>(at.row(i) + j),
                          load<V>(b.y_bar.row(i) + j)));
  apply_gate(b.gate, b.x_bar);
}

template void apply_gate<float>(const Gate<float>&, Lanes<float>);
template void apply_gate<double>(const Gate<double>&, Lanes<double>);
template class ActivationLayer<float>;
template class ActivationLayer<double>;

}  // namespace physinv::nn
