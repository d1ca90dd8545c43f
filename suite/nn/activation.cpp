#include "suite/nn/activation.h"

#include <algorithm>
#include <memory>
#include <type_traits>
#include <vector>

namespace physinv::nn {
namespace {

/// Calls f(offset) for every vector of rows [first, last).
template <class T, class F>
void each_vector(Rows<T> x, Index first, Index last, F&& f) {
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

// A separate loop for ReLU: it costs less than a test at each vector.

template <class T>
void activate_rows(Activation a, Rows<T> z, Index first, Index last) {
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
void apply_gate(const Gate<T>& gate, Rows<T> x_bar) {
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
                        Rows<const T> y_dot,
                        Rows<T> x_bar,
                        Rows<T> x_bar_dot) {
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

template decltype(activate_rows<float>) activate_rows<float>;
template decltype(activate_rows<double>) activate_rows<double>;
template decltype(apply_gate<float>) apply_gate<float>;
template decltype(apply_gate<double>) apply_gate<double>;
template decltype(apply_gate_tangent<float>) apply_gate_tangent<float>;
template decltype(apply_gate_tangent<double>) apply_gate_tangent<double>;

namespace {

template <class T>
class ActivationLayer final : public Layer<T> {
 public:
  ActivationLayer(Activation a, Index features)
      : Layer<T>(features, features), activation_(a) {}

  Activation kind() const { return activation_; }
  const Activation* pure_activation() const override { return &activation_; }
  void forward(const Run<T>&, Rows<const T> x, Rows<T> y) const override {
    using V = NarrowPack<T>;
    each_vector(x, 0, x.rows, [&](Index k) {
      store(y.data + k, activate_lanes<T>(activation_, load<V>(x.data + k)));
    });
  }

  void backward(const Replay<T>&, const Backward<T>& b) const override {
    using V = NarrowPack<T>;
    if (!b.x_bar) return;
    const Rows<const T> at = from_output(activation_) ? b.y : b.x;
    each_vector(at, 0, at.rows, [&](Index k) {
      store(b.x_bar.data + k,
            pull_lanes<T>(
                activation_, load<V>(at.data + k), load<V>(b.y_bar.data + k)));
    });
    apply_gate(b.gate, b.x_bar);
  }
  void tangent(const Replay<T>&, const Tangent<T>& t) const override {
    const Rows<const T> at = from_output(activation_) ? t.y : t.x;
    std::copy_n(t.x_dot.data, t.y_dot.rows * t.y_dot.stride, t.y_dot.data);
    apply_gate<T>({activation_, at}, t.y_dot);
  }

  void backward_tangent(const Replay<T>&,
                        const BackwardTangent<T>& b) const override {
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
  bool evaluate_plainly(const double* /*parameters*/,
                        const Vector<double>& x,
                        Vector<double>& y) const override {
    for (Index i = 0; i < x.size(); ++i) y(i) = activate(activation_, x(i));
    return true;
  }

 private:
  Activation activation_;
};

}  // namespace

template <class T>
LayerPointer<T> activation_layer(Activation a, Index features) {
  return std::make_unique<ActivationLayer<T>>(a, features);
}

template decltype(activation_layer<float>) activation_layer<float>;
template decltype(activation_layer<double>) activation_layer<double>;

}  // namespace physinv::nn
