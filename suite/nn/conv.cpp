#include "suite/nn/conv.h"

#include <algorithm>

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

}  // namespace

// ------------------------------------------------------------------- Conv

template <class T>
Conv<T>::Conv(const ConvOptions& o)
    : Layer<T>(o.grid.positions() * o.in, output(o).positions() * o.out),
      conv_(o.grid, o.in, o.out, o.taps, o.padding),
      padding_(o.padding) {}

template <class T>
std::vector<TensorInfo> Conv<T>::tensors() const {
  return conv_.tensors();
}

template <class T>
bool Conv<T>::fuse(Activation a) {
  if (activation_ != Activation::identity || !from_output(a)) return false;
  activation_ = a;
  return true;
}

template <class T>
void Conv<T>::forward(const LayerArgs<T>& at,
                      Lanes<const T> x,
                      Lanes<T> y) const {
  const Index out = conv_.shape().out;
  conv_.forward(at, x, y, [&](Index, Index begin, Index end) {
    activate_rows(activation_, y, begin * out, end * out);
  });
}

/// Without padding, where the taps of position p start at p.
template <class T>
bool Conv<T>::evaluate_plainly(const double* parameters,
                               const Vector<double>& x,
                               Vector<double>& y) const {
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

template <class T>
void Conv<T>::backward(const LayerArgs<T>& at, const Backward<T>& b) const {
  conv_.gradients(
      at, b.x, b.y_bar, 1, b.parameters_bar, b.x_bar, [](Index, Index) {});
  if (b.x_bar) apply_gate(b.gate, b.x_bar);
  if (b.parameters_bar != nullptr)
    channel_sums<T>(*at.work,
                    b.y_bar,
                    conv_.shape().out,
                    b.parameters_bar + conv_.shape().weights());
}

template <class T>
void Conv<T>::tangent(const LayerArgs<T>& at, const Tangent<T>& t) const {
  push_convolution(
      conv_, at, t.x, t.x_dot, t.y_dot, [](Index, Index, Index) {});
  apply_gate<T>({activation_, t.y}, t.y_dot);
}

template <class T>
void Conv<T>::backward_tangent(const LayerArgs<T>& at,
                               const BackwardTangent<T>& b) const {
  const ConvShape& shape = conv_.shape();
  pull_convolution(conv_, at, b, b.y_bar, b.y_bar_dot);
  const auto biases = [&](Lanes<const T> y_bar, T* parameters_bar) {
    if (parameters_bar != nullptr)
      channel_sums<T>(
          *at.work, y_bar, shape.out, parameters_bar + shape.weights());
  };
  biases(b.y_bar, b.parameters_bar);
  biases(b.y_bar_dot, b.parameters_bar_dot);
}

template <class T>
void Conv<T>::add_rows(Lanes<const T> x,
                       Lanes<const T> y_bar,
                       Index offset,
                       std::vector<LayerRows<T>>& layers) const {
  SUITE_CHECK(padding_ == Padding::none, "patches reach into the padding");
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

// -------------------------------------------------------------- ConvBlock

template <class T>
ConvBlock<T>::ConvBlock(const ConvOptions& o, Activation activation, bool pool)
    : Layer<T>(o.grid.positions() * o.in,
               rows({.grid = output(o), .channels = o.out, .pool = pool})),
      conv_(o.grid, o.in, o.out, o.taps, o.padding),
      norm_{.grid = output(o),
            .channels = o.out,
            .activation = activation,
            .pool = pool},
      batch_statistics_(o.batch_statistics) {
  SUITE_CHECK(from_output(activation), "the activation needs a layer");
}

template <class T>
std::vector<TensorInfo> ConvBlock<T>::tensors() const {
  auto all = conv_.tensors();
  const Index n = norm_.channels;
  all.push_back({.name = {}, .kind = 's', .offset = 0, .size = n, .fan_in = n});
  all.push_back({.name = {}, .kind = 'o', .offset = 0, .size = n, .fan_in = n});
  return all;
}

template <class T>
void ConvBlock<T>::initialize_state(T* state) const {
  if (batch_statistics_) return;
  std::fill_n(state, norm_.channels, T(0));
  std::fill_n(state + norm_.channels, norm_.channels, T(1));
}

template <class T>
void ConvBlock<T>::forward(const LayerArgs<T>& at,
                           Lanes<const T> x,
                           Lanes<T> y) const {
  const Index channels = norm_.channels, positions = norm_.positions();
  Lanes<T> z(nullptr, conv_.outputs(), x.samples);
  z.data = at.tape->template slot<T>(at.slot, z.stride, z.rows).data();
  const NormColumns<T> kept(
      at.tape->template slot<T>(at.slot + 1, channels, NormColumns<T>::kCount)
          .data(),
      channels);
  const Workspace::Scope scope(*at.work);
  if (by_batch(at)) {
    T* moments =
        at.work->template take<T>(2 * channels, conv_.blocks(z)).data();
    conv_.forward(at, x, z, [&](Index block, Index begin, Index end) {
      block_moments<T>(z, channels, begin, end, moments + 2 * channels * block);
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
               normalise<T>(norm_,
                            kept,
                            parameters,
                            z,
                            y,
                            block * some,
                            std::min((block + 1) * some, outputs));
             });
}

/// And the gradients by bias, scale and offset, which are their sums.
template <class T>
const T* ConvBlock<T>::pulled_means(const LayerArgs<T>& at,
                                    const Backward<T>& b,
                                    const NormColumns<T>& kept,
                                    Lanes<const T> z) const {
  const Index channels = norm_.channels, samples = b.x.samples;
  const T* parameters = at.parameters + conv_.parameter_count();
  const Index outputs = norm_.pooled().positions();
  const Index some = conv_.per_block(z), blocks = (outputs + some - 1) / some;
  T* sums = at.work->template take<T>(2 * channels, blocks).data();
  for_blocks(conv_.threads(at, samples), blocks, [&](Index block, int) {
    block_sums<T>(norm_,
                  kept,
                  parameters,
                  z,
                  b.y,
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
      bias_bar[c] =
          by_batch(at) ? T(0) : parameters[c] * kept.inverse[c] * means[c];
    }
  }
  // Outside training the statistics are constants.
  const T share =
      by_batch(at) ? T(1) / static_cast<T>(norm_.positions() * samples) : T(0);
  for (Index c = 0; c < 2 * channels; ++c) means[c] *= share;
  return means;
}

template <class T>
void ConvBlock<T>::backward(const LayerArgs<T>& at,
                            const Backward<T>& b) const {
  const Index samples = b.x.samples;
  const Lanes<const T> z(
      at.tape->template view<T>(at.slot).data(), conv_.outputs(), samples);
  const NormColumns<T> kept(at.tape->template view<T>(at.slot + 1).data(),
                            norm_.channels);
  const T* parameters = at.parameters + conv_.parameter_count();
  const Workspace::Scope scope(*at.work);
  const T* const means = pulled_means(at, b, kept, z);

  Lanes<T> z_bar(nullptr, z.rows, samples);
  z_bar.data = at.work->template take<T>(z.stride, z.rows).data();
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
                    pull_norm<T>(norm_,
                                 kept,
                                 parameters,
                                 means,
                                 z,
                                 b.y,
                                 b.y_bar,
                                 z_bar,
                                 begin / cell,
                                 end / cell);
                  });
  if (b.x_bar) apply_gate(b.gate, b.x_bar);
}

template <class T>
void ConvBlock<T>::tangent(const LayerArgs<T>& at, const Tangent<T>& t) const {
  push_block<T>({conv_, norm_, by_batch(at)}, at, t);
}

template <class T>
void ConvBlock<T>::backward_tangent(const LayerArgs<T>& at,
                                    const BackwardTangent<T>& b) const {
  pull_block<T>({conv_, norm_, by_batch(at)}, at, b);
}

template <class T>
void ConvBlock<T>::update_state(const Tape& tape,
                                std::size_t slot,
                                T* state) const {
  if (batch_statistics_) return;
  move_state(NormColumns<T>(tape.view<T>(slot + 1).data(), norm_.channels),
             norm_.channels,
             state);
}

template class Conv<float>;
template class Conv<double>;
template class ConvBlock<float>;
template class ConvBlock<double>;

}  // namespace physinv::nn
