#include "suite/nn/linear.h"

#include "suite/nn/activation.h"
#include "suite/nn/gemm.h"

namespace physinv::nn {
namespace {

/// b + W_const x_const, one number per output.
template <class T>
void fold_bias(const T* weights,
               const T* bias,
               const LayerArgs<T>& at,
               Lanes<const T> x,
               Index outputs,
               T* folded) {
  for (Index i = 0; i < outputs; ++i) folded[i] = bias[i];
  const auto add = [&](Index begin, Index end) {
    for (Index i = 0; i < outputs; ++i) {
      const T* row = weights + i * x.rows;
      T sum = folded[i];
      for (Index j = begin; j < end; ++j) sum += row[j] * x.row(j)[0];
      folded[i] = sum;
    }
  };
  add(0, at.leading);
  add(x.rows - at.trailing, x.rows);
}

}  // namespace

template <class T>
std::vector<TensorInfo> Linear<T>::tensors() const {
  const Index in = this->inputs(), out = this->outputs();
  return {
      {.name = {}, .kind = 'm', .offset = 0, .size = in * out, .fan_in = in},
      {.name = {}, .kind = 'b', .offset = 0, .size = out, .fan_in = in}};
}

template <class T>
bool Linear<T>::fuse(Activation a) {
  if (activation_ != Activation::identity || !from_output(a)) return false;
  activation_ = a;
  return true;
}

template <class T>
double Linear<T>::operations() const {
  return 2.0 * static_cast<double>(this->inputs() * this->outputs());
}

template <class T>
void Linear<T>::forward(const LayerArgs<T>& at,
                        Lanes<const T> x,
                        Lanes<T> y) const {
  const Index in = this->inputs(), out = this->outputs();
  const Index first = at.leading, folded = at.leading + at.trailing;
  const T* bias = at.parameters + in * out;
  const Workspace::Scope scope(*at.work);
  if (folded > 0) {
    auto b = at.work->template take<T>(out, 1);
    fold_bias(at.parameters, bias, at, x, out, b.data());
    bias = b.data();
  }
  gemm<T>({.m = out,
           .n = x.width,
           .k = in - folded,
           .a = at.parameters + first,
           .a_row = in,
           .a_k = 1,
           .b = x.row(first),
           .b_stride = x.stride,
           .c = y.data,
           .c_stride = y.stride,
           .bias = bias,
           .activation = activation_},
          at.work->threads());
}

template <class T>
void Linear<T>::weight_gradient(const LayerArgs<T>& at,
                                const Backward<T>& b) const {
  const Index in = this->inputs(), out = this->outputs();
  const Index first = at.leading, end = in - at.trailing;
  T* bias_bar = b.parameters_bar + in * out;
  row_sums<T>(b.y_bar, bias_bar);
  for (Index i = 0; i < out && end - first < in; ++i) {
    T* row = b.parameters_bar + i * in;
    for (Index j = 0; j < first; ++j) row[j] = bias_bar[i] * b.x.row(j)[0];
    for (Index j = end; j < in; ++j) row[j] = bias_bar[i] * b.x.row(j)[0];
  }
  if (end == first) return;
  const Workspace::Scope scope(*at.work);
  const Index stride = lane_stride<T>(round_up(end - first, kLanes<T>));
  auto xt = at.work->template take<T>(stride, b.x.samples);
  // The columns behind the last feature are multiplied, never stored.
  for (Index s = 0; s < b.x.samples; ++s)
    for (Index j = end - first; j < round_up(end - first, kLanes<T>); ++j)
      xt(j, s) = T(0);
  transpose(
      b.x.row(first), b.x.stride, end - first, b.x.samples, xt.data(), stride);
  gemm<T>({.m = out,
           .n = end - first,
           .k = b.x.samples,
           .a = b.y_bar.data,
           .a_row = b.y_bar.stride,
           .a_k = 1,
           .b = xt.data(),
           .b_stride = stride,
           .c = b.parameters_bar + first,
           .c_stride = in},
          at.work->threads());
}

template <class T>
void Linear<T>::backward(const LayerArgs<T>& at, const Backward<T>& b) const {
  if (b.parameters_bar != nullptr) weight_gradient(at, b);
  if (!b.x_bar) return;
  gemm<T>({.m = this->inputs(),
           .n = b.y_bar.width,
           .k = this->outputs(),
           .a = at.parameters,
           .a_row = 1,
           .a_k = this->inputs(),
           .b = b.y_bar.data,
           .b_stride = b.y_bar.stride,
           .c = b.x_bar.data,
           .c_stride = b.x_bar.stride,
           .gate_activation = b.gate.activation,
           .gate = b.gate.y.data,
           .gate_stride = b.gate.y.stride},
          at.work->threads());
}

template class Linear<float>;
template class Linear<double>;

}  // namespace physinv::nn
