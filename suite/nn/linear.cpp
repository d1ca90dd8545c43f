#include "suite/nn/linear.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "suite/nn/activation.h"
#include "suite/nn/gemm.h"
#include "suite/nn/thin_product.h"

namespace physinv::nn {
namespace {

/// The features that are constant over the batch: columns [0, leading) and
/// [end, in) of the weights, with their values, contiguous.
template <class T>
struct Constants {
  Constants(const Replay<T>& at, Rows<const T> x)
      : leading(at.leading),
        end(x.rows - at.trailing),
        values(at.work->template take<T>(x.rows, 1)) {
    for (Index j = 0; j < leading; ++j) values(j) = x.row(j)[0];
    for (Index j = end; j < x.rows; ++j) values(j) = x.row(j)[0];
  }
  Index leading, end;
  Scratch<T> values;
};

/// b + W_const x_const, one number per output. Rows are taken in groups, so
/// that their sums, each in order, hide each other's latency.
template <class T>
void fold_bias(const T* weights,
               const T* bias,
               const Constants<T>& x,
               Index outputs,
               T* folded) {
  constexpr Index kSums = 8;
  const Index in = x.values.rows();
  for (Index i = 0; i < outputs; i += kSums) {
    const Index rows = std::min(kSums, outputs - i);
    T sum[kSums] = {};
    for (Index r = 0; r < rows; ++r) sum[r] = bias[i + r];
    const auto add = [&](Index begin, Index end) {
      for (Index j = begin; j < end; ++j)
        for (Index r = 0; r < rows; ++r)
          sum[r] += weights[(i + r) * in + j] * x.values(j);
    };
    add(0, x.leading);
    add(x.end, in);
    for (Index r = 0; r < rows; ++r) folded[i + r] = sum[r];
  }
}

template <class T>
class Linear final : public Layer<T> {
 public:
  Linear(Index inputs, Index outputs) : Layer<T>(inputs, outputs) {}

  std::vector<TensorInfo> tensors() const override {
    const Index in = this->inputs(), out = this->outputs();
    return {{.kind = 'm', .size = in * out, .fan_in = in, .fan_out = out},
            {.kind = 'b', .size = out, .fan_in = in, .fan_out = out}};
  }
  bool fuse(Activation a) override {
    if (activation_ != Activation::identity || !from_output(a)) return false;
    activation_ = a;
    return true;
  }
  bool folds_constants() const override { return true; }
  Activation fused() const override { return activation_; }
  void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const override {
    const Index in = this->inputs(), out = this->outputs();
    const Index first = at.leading, folded = at.leading + at.trailing;
    const T* bias = at.parameters + in * out;
    const Workspace::Scope scope(*at.work);
    if (folded > 0) {
      auto b = at.work->template take<T>(out, 1);
      fold_bias(at.parameters, bias, Constants<T>(at, x), out, b.data());
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

  void backward(const Replay<T>& at, const Backward<T>& b) const override {
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

  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    const Index in = this->inputs(), out = this->outputs();
    const Workspace::Scope scope(*at.work);
    const Rows<T> more = take_rows<T>(*at.work, out, t.x.samples);
    const auto product =
        [&](const T* weights, const T* bias, Rows<const T> x, Rows<T> y) {
          gemm<T>({.m = out,
                   .n = x.width,
                   .k = in,
                   .a = weights,
                   .a_row = in,
                   .a_k = 1,
                   .b = x.data,
                   .b_stride = x.stride,
                   .c = y.data,
                   .c_stride = y.stride,
                   .bias = bias},
                  at.work->threads());
        };
    product(t.parameters_dot, t.parameters_dot + in * out, t.x, t.y_dot);
    product(at.parameters, nullptr, t.x_dot, more);
    add_to_rows<T>(more, t.y_dot);
    apply_gate<T>({activation_, t.y}, t.y_dot);
  }

  /// `backward` is bilinear in (weights, x) and y_bar; the biases' part in
  /// y_bar alone.
  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    const Index weights = this->inputs() * this->outputs();
    backward(at, b.base());
    backward(at, b.base_dot());
    const Workspace::Scope scope(*at.work);
    Replay<T> cross = at;
    cross.parameters = b.parameters_dot;
    auto sum = at.work->template take<T>(weights + this->outputs(), 1);
    Rows<T> more;
    if (b.x_bar) more = take_rows<T>(*at.work, this->inputs(), b.x.samples);
    backward(cross,
             {.x = b.x_dot,
              .y = b.y,
              .y_bar = b.y_bar,
              .parameters_bar = sum.data(),
              .x_bar = more});
    for (Index i = 0; i < weights; ++i) b.parameters_bar_dot[i] += sum(i);
    if (b.x_bar) add_to_rows<T>(more, b.x_bar_dot);
  }

  void add_rows(Rows<const T> x,
                Rows<const T> y_bar,
                Index offset,
                std::vector<LayerRows<T>>& layers) const override {
    layers.push_back({.offset = offset,
                      .inputs = this->inputs(),
                      .outputs = this->outputs(),
                      .a = x.data,
                      .a_stride = x.stride,
                      .b = y_bar.data,
                      .b_stride = y_bar.stride});
  }

  bool evaluate_plainly(const double* parameters,
                        const Vector<double>& x,
                        Vector<double>& y) const override {
    const Index in = this->inputs(), out = this->outputs();
    for (Index o = 0; o < out; ++o) {
      double sum = parameters[out * in + o];
      for (Index i = 0; i < in; ++i) sum += parameters[o * in + i] * x(i);
      y(o) = activate(activation_, sum);
    }
    return true;
  }
  double operations() const override {
    return 2.0 * static_cast<double>(this->inputs() * this->outputs());
  }

 private:
  void weight_gradient(const Replay<T>& at, const Backward<T>& b) const {
    const Index in = this->inputs(), out = this->outputs();
    const Index first = at.leading, end = in - at.trailing;
    T* bias_bar = b.parameters_bar + in * out;
    row_sums<T>(b.y_bar, bias_bar);
    const Workspace::Scope scope(*at.work);
    if (end - first < in) {
      const Constants<T> constants(at, b.x);
      const T* const x = constants.values.data();
      for (Index i = 0; i < out; ++i) {
        T* const row = b.parameters_bar + i * in;
        const T y_bar = bias_bar[i];
        for (Index j = 0; j < first; ++j) row[j] = y_bar * x[j];
        for (Index j = end; j < in; ++j) row[j] = y_bar * x[j];
      }
    }
    if (end == first) return;
    if (are_thin(out, end - first)) {
      Rows<const T> x = b.x;
      x.data = x.row(first), x.rows = end - first;
      return row_products(b.y_bar, x, b.parameters_bar + first, in, Index{1});
    }
    const Index stride = row_stride<T>(round_up(end - first, kNarrowLanes<T>));
    auto xt = at.work->template take<T>(stride, b.x.samples);
    // The columns behind the last feature are multiplied, never stored.
    transpose(b.x.row(first),
              b.x.stride,
              end - first,
              b.x.samples,
              xt.data(),
              stride,
              Behind::zeros);
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

  Activation activation_ = Activation::identity;
};

}  // namespace

template <class T>
LayerPointer<T> linear(Index inputs, Index outputs) {
  return std::make_unique<Linear<T>>(inputs, outputs);
}

template decltype(linear<float>) linear<float>;
template decltype(linear<double>) linear<double>;

}  // namespace physinv::nn
