#include "suite/nn/encoding.h"

#include <cmath>
#include <memory>
#include <vector>

#include "suite/core/math_lanes.h"
#include "suite/nn/activation.h"

namespace physinv::nn {

namespace {

template <class T>
class PositionalEncoding final : public Layer<T> {
 public:
  PositionalEncoding(Index inputs, Index frequencies)
      : Layer<T>(inputs, 2 * frequencies * inputs), frequencies_(frequencies) {}

  void forward(const Run<T>&, Rows<const T> x, Rows<T> y) const override {
    constexpr Index kWidth = 4;
    for (Index i = 0; i < x.rows; ++i) {
      const T* a = x.row(i);
      T* out = y.row(2 * frequencies_ * i);
      for (Index j = 0; j < x.width; j += kWidth) {
        double at[kWidth], s[kWidth], c[kWidth];
        for (Index l = 0; l < kWidth; ++l)
          at[l] = j + l < x.samples ? double(a[j + l]) : 0.0;
        const auto [s1, c1] = math::sincos(load<Pack<double, 4>>(at));
        store(s, s1), store(c, c1);
        for (Index k = 0; k < frequencies_; ++k)
          for (Index l = 0; l < kWidth; ++l) {
            out[k * y.stride + j + l] = static_cast<T>(s[l]);
            out[(frequencies_ + k) * y.stride + j + l] = static_cast<T>(c[l]);
            const double next = std::fma(s[l], c1[l], c[l] * s1[l]);
            c[l] = std::fma(c[l], c1[l], -(s[l] * s1[l])), s[l] = next;
          }
      }
    }
  }

  void backward(const Replay<T>&, const Backward<T>& b) const override {
    using V = NarrowPack<T>;
    if (!b.x_bar) return;
    const Index n = frequencies_;
    for (Index i = 0; i < b.x.rows; ++i) {
      T* bar = b.x_bar.row(i);
      for (Index j = 0; j < b.x.width; ++j) bar[j] = T(0);
      for (Index k = 0; k < n; ++k) {
        const Index sine = 2 * n * i + k, cosine = sine + n;
        const T *s = b.y.row(sine), *c = b.y.row(cosine);
        const T *s_bar = b.y_bar.row(sine), *c_bar = b.y_bar.row(cosine);
        const V f = broadcast<V>(static_cast<T>(k + 1));
        for (Index j = 0; j < b.x.width; j += kNarrowLanes<T>) {
          const V cross = load<V>(s + j) * load<V>(c_bar + j);
          const V slope = fma_lanes(load<V>(c + j), load<V>(s_bar + j), -cross);
          store(bar + j, fma_lanes(f, slope, load<V>(bar + j)));
        }
      }
    }
    apply_gate(b.gate, b.x_bar);
  }

  void tangent(const Replay<T>&, const Tangent<T>& t) const override {
    using V = NarrowPack<T>;
    for (Index i = 0; i < t.x.rows; ++i)
      for (Index k = 0; k < frequencies_; ++k) {
        const Index sine = 2 * frequencies_ * i + k,
                    cosine = sine + frequencies_;
        const V f = broadcast<V>(static_cast<T>(k + 1));
        for (Index j = 0; j < t.x.width; j += kNarrowLanes<T>) {
          const V turn = f * load<V>(t.x_dot.row(i) + j);
          store(t.y_dot.row(sine) + j, turn * load<V>(t.y.row(cosine) + j));
          store(t.y_dot.row(cosine) + j, -turn * load<V>(t.y.row(sine) + j));
        }
      }
  }

  /// `backward` is bilinear in y and y_bar.
  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    if (!b.x_bar) return;
    backward(at, b.base());
    backward(at, b.base_dot());
    const Workspace::Scope scope(*at.work);
    const Rows<T> more = take_rows<T>(*at.work, b.x_bar.rows, b.x_bar.samples);
    backward(at, {.x = b.x, .y = b.y_dot, .y_bar = b.y_bar, .x_bar = more});
    add_to_rows<T>(more, b.x_bar_dot);
  }

 private:
  Index frequencies_;
};

}  // namespace

template <class T>
LayerPointer<T> positional_encoding(Index inputs, Index frequencies) {
  return std::make_unique<PositionalEncoding<T>>(inputs, frequencies);
}

template decltype(positional_encoding<float>) positional_encoding<float>;
template decltype(positional_encoding<double>) positional_encoding<double>;

}  // namespace physinv::nn
