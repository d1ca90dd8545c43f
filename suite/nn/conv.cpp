#include "suite/nn/conv.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "suite/core/check.h"
#include "suite/nn/activation.h"
#include "suite/nn/conv_tangent.h"
#include "suite/nn/convolution_tangent.h"

namespace physinv::nn {
namespace {

Grid output(const ConvOptions& o) {
  return window_output(o.grid, o.taps, o.padding);
}

Index rows(const NormShape& s) { return s.pooled().positions() * s.channels; }

template <class T>
class Conv final : public Layer<T> {
 public:
  explicit Conv(const ConvOptions& o)
      : Layer<T>(o.grid.positions() * o.in, output(o).positions() * o.out),
        conv_(o.grid, o.in, o.out, o.taps, o.padding),
        padding_(o.padding) {}

  std::vector<TensorInfo> tensors() const override { return conv_.tensors(); }
  bool fuse(Activation a) override {
    if (activation_ != Activation::identity || !from_output(a)) return false;
    activation_ = a;
    return true;
  }
  Activation fused() const override { return activation_; }
  void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const override {
    const Index out = conv_.shape().out;
    conv_.forward(at, x, y, [&](Index, Index begin, Index end) {
      activate_rows(activation_, y, begin * out, end * out);
    });
  }

  void backward(const Replay<T>& at, const Backward<T>& b) const override {
    conv_.gradients(
        at, b.x, b.y_bar, 1, b.parameters_bar, b.x_bar, [](Index, Index) {});
    if (b.x_bar) apply_gate(b.gate, b.x_bar);
    if (b.parameters_bar != nullptr)
      channel_sums<T>(*at.work,
                      b.y_bar,
                      conv_.shape().out,
                      b.parameters_bar + conv_.shape().weights());
  }
  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    push_convolution(conv_, at, t, t.y_dot, [](Index, Index, Index) {});
    apply_gate<T>({activation_, t.y}, t.y_dot);
  }

  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    const ConvShape& shape = conv_.shape();
    pull_convolution(conv_, at, b, b.y_bar, b.y_bar_dot);
    const auto biases = [&](Rows<const T> y_bar, T* parameters_bar) {
      if (parameters_bar != nullptr)
        channel_sums<T>(
            *at.work, y_bar, shape.out, parameters_bar + shape.weights());
    };
    biases(b.y_bar, b.parameters_bar);
    biases(b.y_bar_dot, b.parameters_bar_dot);
  }

  /// Without padding only: the patches then lie in x as they are.
  void add_rows(Rows<const T> x,
                Rows<const T> y_bar,
                Index offset,
                std::vector<LayerRows<T>>& layers) const override {
    SUITE_CHECK(padding_ == Padding::none,
                "patches are only implemented without padding");
    const ConvShape& shape = conv_.shape();
    layers.push_back({.offset = offset,
                      .inputs = shape.depth(),
                      .outputs = shape.out,
                      .a = x.data,
                      .a_stride = x.stride,
                      .b = y_bar.data,
                      .b_stride = y_bar.stride,
                      .positions = shape.positions(),
                      .a_step = shape.in,
                      .b_step = shape.out,
                      .taps = shape.taps.count()});
  }

  /// Without padding, where the taps of position p start at p.
  bool evaluate_plainly(const double* parameters,
                        const Vector<double>& x,
                        Vector<double>& y) const override {
    if (padding_ != Padding::none) return false;
    const auto& [grid, in, out, taps] = conv_.shape();
    for (Index p = 0; p < grid.columns; ++p) {
      for (Index o = 0; o < out; ++o) {
        double sum = parameters[conv_.shape().weights() + o];
        for (Index c = 0; c < in; ++c)
          for (Index t = 0; t < taps.x; ++t)
            sum += parameters[(o * in + c) * taps.x + t] * x((p + t) * in + c);
        y(p * out + o) = activate(activation_, sum);
      }
    }
    return true;
  }
  double operations() const override { return conv_.operations(); }

 private:
  Convolution<T> conv_;
  Padding padding_;
  Activation activation_ = Activation::identity;
};

template <class T>
class ConvBlock final : public Layer<T> {
 public:
  ConvBlock(const ConvOptions& o, Activation activation, bool pool)
      : Layer<T>(o.grid.positions() * o.in,
                 rows({.grid = output(o), .channels = o.out, .pool = pool})),
        conv_(o.grid, o.in, o.out, o.taps, o.padding),
        norm_{.grid = output(o),
              .channels = o.out,
              .activation = activation,
              .pool = pool},
        batch_statistics_(o.batch_statistics) {
    SUITE_CHECK(from_output(activation),
                "this activation needs a separate layer");
  }

  std::vector<TensorInfo> tensors() const override {
    auto all = conv_.tensors();
    const Index n = norm_.channels;
    all.push_back(
        {.name = {}, .kind = 's', .offset = 0, .size = n, .fan_in = n});
    all.push_back(
        {.name = {}, .kind = 'o', .offset = 0, .size = n, .fan_in = n});
    return all;
  }
  Index state_count() const override {
    return batch_statistics_ ? 0 : 2 * norm_.channels;
  }
  void initialize_state(T* state) const override {
    if (batch_statistics_) return;
    std::fill_n(state, norm_.channels, T(0));
    std::fill_n(state + norm_.channels, norm_.channels, T(1));
  }
  std::size_t slots() const override { return 2; }
  void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const override {
    const Index channels = norm_.channels, positions = norm_.positions();
    const auto z = open_rows<T>(*at.tape, at.slot, conv_.outputs(), x.samples);
    const NormColumns<T> kept(
        at.tape->template slot<T>(at.slot + 1, channels, NormColumns<T>::kCount)
            .data(),
        channels);
    const Workspace::Scope scope(*at.work);
    if (by_batch(at)) {
      T* moments =
          at.work->template take<T>(2 * channels, conv_.blocks(z)).data();
      conv_.forward(at, x, z, [&](Index block, Index begin, Index end) {
        block_moments<T>(
            z, channels, begin, end, moments + 2 * channels * block);
      });
      combine_moments<T>(
          moments, channels, positions, conv_.per_block(z), x.samples, kept);
    } else {
      conv_.forward(at, x, z, [](Index, Index, Index) {});
      use_state(at.state, channels, kept);
    }
    const T* parameters = at.parameters + conv_.parameter_count();
    const Index outputs = norm_.pooled().positions();
    const Index some = conv_.per_block(z);
    for_blocks(conv_.threads(at, x.samples),
               (outputs + some - 1) / some,
               [&](Index block, int) {
                 normalise<T>({norm_, kept, parameters, z, {}},
                              y,
                              block * some,
                              std::min((block + 1) * some, outputs));
               });
  }

  void backward(const Replay<T>& at, const Backward<T>& b) const override {
    const Index samples = b.x.samples;
    const Rows<const T> z =
        kept_rows<T>(*at.tape, at.slot, conv_.outputs(), samples);
    const NormColumns<T> kept(at.tape->template view<T>(at.slot + 1).data(),
                              norm_.channels);
    const NormPass<T> of{
        norm_, kept, at.parameters + conv_.parameter_count(), z, b.y};
    const Workspace::Scope scope(*at.work);
    const T* const means = pulled_means(at, b, of);

    const Rows<T> z_bar = take_rows<T>(*at.work, z.rows, samples);
    // Cells of whole rows, where pooling joins rows.
    const Index cell = norm_.positions() / norm_.pooled().positions();
    const Index unit = cell == 4 ? 2 * norm_.grid.columns : cell;
    conv_.gradients(at,
                    b.x,
                    z_bar,
                    unit,
                    b.parameters_bar,
                    b.x_bar,
                    [&](Index begin, Index end) {
                      pull_norm(
                          of, means, b.y_bar, z_bar, begin / cell, end / cell);
                    });
    if (b.x_bar) apply_gate(b.gate, b.x_bar);
  }
  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    push_block<T>({conv_, norm_, by_batch(at)}, at, t);
  }
  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    pull_block<T>({conv_, norm_, by_batch(at)}, at, b);
  }

  void update_state(const Tape& tape,
                    std::size_t slot,
                    T* state) const override {
    if (batch_statistics_) return;
    move_state(NormColumns<T>(tape.view<T>(slot + 1).data(), norm_.channels),
               norm_.channels,
               state);
  }
  double operations() const override { return conv_.operations(); }

 private:
  /// Means over samples and positions that the cotangent of a normalisation
  /// needs (2 x channels).
  /// And the gradients by bias, scale and offset, which are their sums.
  const T* pulled_means(const Replay<T>& at,
                        const Backward<T>& b,
                        const NormPass<T>& of) const {
    const Index channels = norm_.channels, samples = b.x.samples;
    const Index outputs = norm_.pooled().positions();
    const Index some = conv_.per_block(of.x),
                blocks = (outputs + some - 1) / some;
    T* sums = at.work->template take<T>(2 * channels, blocks).data();
    for_blocks(conv_.threads(at, samples), blocks, [&](Index block, int) {
      block_sums<T>(of,
                    b.y_bar,
                    block * some,
                    std::min((block + 1) * some, outputs),
                    sums + 2 * channels * block);
    });
    T* means = at.work->template take<T>(2 * channels, 1).data();
    combine_sums(sums, blocks, channels, means);
    if (b.parameters_bar != nullptr) {
      T* bias_bar = b.parameters_bar + conv_.shape().weights();
      T *scale_bar = bias_bar + channels, *offset_bar = scale_bar + channels;
      for (Index c = 0; c < channels; ++c) {
        offset_bar[c] = means[c], scale_bar[c] = means[channels + c];
        bias_bar[c] = by_batch(at)
                          ? T(0)
                          : of.parameters[c] * of.at.inverse[c] * means[c];
      }
    }
    // Outside training the statistics are constants.
    const T share = by_batch(at)
                        ? T(1) / static_cast<T>(norm_.positions() * samples)
                        : T(0);
    for (Index c = 0; c < 2 * channels; ++c) means[c] *= share;
    return means;
  }
  bool by_batch(const Replay<T>& at) const {
    return at.training || batch_statistics_;
  }

  Convolution<T> conv_;
  NormShape norm_;
  bool batch_statistics_;
};

}  // namespace

template <class T>
LayerPointer<T> conv(const ConvOptions& options) {
  return std::make_unique<Conv<T>>(options);
}

template <class T>
LayerPointer<T> conv_block(const ConvOptions& options,
                           Activation activation,
                           bool pool) {
  return std::make_unique<ConvBlock<T>>(options, activation, pool);
}

#define PHYSINV_INSTANTIATE(T)        \
  template decltype(conv<T>) conv<T>; \
  template decltype(conv_block<T>) conv_block<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
