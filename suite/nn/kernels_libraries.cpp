// The products of networks by libraries, to compare with the suite's own:
// convolutions by oneDNN in whatever order of memory it likes best, small
// matrices by libxsmm. Rows that the build links a library for
// (PHYSINV_BENCH_DNNL, PHYSINV_BENCH_XSMM). One thread.
#include <unordered_map>
#include <utility>
#include <vector>

#include "suite/core/workspace.h"
#include "suite/nn/conv.h"
#include "suite/nn/kernels.h"

#ifdef PHYSINV_BENCH_DNNL
#include <dnnl.hpp>
extern "C" void omp_set_num_threads(int count);
#endif
#ifdef PHYSINV_BENCH_XSMM
#include <libxsmm.h>
#endif

namespace physinv::nn {
namespace {

using benchmark::State;

/// height x width, channels in and out, samples: layers of the U-nets.
struct ConvShape {
  explicit ConvShape(const State& state)
      : height(state.range(0)),
        width(state.range(1)),
        in(state.range(2)),
        out(state.range(3)),
        n(state.range(4)) {}
  Index height, width, in, out, n;

  /// Of one pass, the border's taps included.
  double flops() const {
    return 2.0 * static_cast<double>(out * height * width * n * 9 * in);
  }
};

enum class Which { forward, weights, input };

template <Which pass>
void own(State& state) {
  const ConvShape shape(state);
  const auto layer = conv<float>({.grid = {shape.height, shape.width},
                                  .in = shape.in,
                                  .out = shape.out,
                                  .taps = {3, 3}});
  const Index inputs = layer->inputs(), outputs = layer->outputs();
  RandomRows<float> x(inputs, shape.n), x_bar(inputs, shape.n);
  RandomRows<float> y(outputs, shape.n), y_bar(outputs, shape.n);
  Index weights = 0;
  for (const TensorInfo& t : layer->tensors()) weights += t.size;
  const Vector<float> p = Vector<float>::Random(weights);
  Vector<float> p_bar(weights);
  Workspace work;
  Tape tape;
  const Run<float> at(
      {.parameters = p.data(), .work = &work, .training = true}, tape, nullptr);
  layer->forward(at, x, y);
  Backward<float> b{.x = x, .y = y, .y_bar = y_bar};
  if (pass == Which::weights) b.parameters_bar = p_bar.data();
  if (pass == Which::input) b.x_bar = x_bar;
  measure_flops(state, shape.flops(), [&] {
    pass == Which::forward ? layer->forward(at, x, y) : layer->backward(at, b);
  });
}

#ifdef PHYSINV_BENCH_DNNL

using dnnl::memory;

/// Descriptions of a layer's parts, in whatever order of memory is fastest.
struct ConvMemory {
  explicit ConvMemory(const ConvShape& s)
      : x(any({s.n, s.in, s.height, s.width})),
        y(any({s.n, s.out, s.height, s.width})),
        w(any({s.out, s.in, 3, 3})),
        b(any({s.out})) {}
  memory::desc x, y, w, b;

 private:
  static memory::desc any(const memory::dims& dims) {
    return {dims, memory::data_type::f32, memory::format_tag::any};
  }
};

/// The primitive of a pass, and its arguments by `make`.
template <Which pass, class Make>
auto primitive(const dnnl::engine& engine, const ConvMemory& m, Make make)
    -> std::pair<dnnl::primitive, std::unordered_map<int, memory>> {
  const memory::dims step = {1, 1}, border = {1, 1};
  const auto direct = dnnl::algorithm::convolution_auto;
  const dnnl::convolution_forward::primitive_desc forward(
      {dnnl::prop_kind::forward_training,
       direct,
       m.x,
       m.w,
       m.b,
       m.y,
       step,
       border,
       border},
      engine);
  if constexpr (pass == Which::forward) {
    return {dnnl::convolution_forward(forward),
            {{DNNL_ARG_SRC, make(forward.src_desc())},
             {DNNL_ARG_WEIGHTS, make(forward.weights_desc())},
             {DNNL_ARG_BIAS, make(forward.bias_desc())},
             {DNNL_ARG_DST, make(forward.dst_desc())}}};
  } else if constexpr (pass == Which::weights) {
    const dnnl::convolution_backward_weights::primitive_desc back(
        {direct, m.x, m.w, m.b, m.y, step, border, border}, engine, forward);
    return {dnnl::convolution_backward_weights(back),
            {{DNNL_ARG_SRC, make(back.src_desc())},
             {DNNL_ARG_DIFF_DST, make(back.diff_dst_desc())},
             {DNNL_ARG_DIFF_WEIGHTS, make(back.diff_weights_desc())},
             {DNNL_ARG_DIFF_BIAS, make(back.diff_bias_desc())}}};
  } else {
    const dnnl::convolution_backward_data::primitive_desc back(
        {direct, m.x, m.w, m.y, step, border, border}, engine, forward);
    return {dnnl::convolution_backward_data(back),
            {{DNNL_ARG_DIFF_SRC, make(back.diff_src_desc())},
             {DNNL_ARG_WEIGHTS, make(back.weights_desc())},
             {DNNL_ARG_DIFF_DST, make(back.diff_dst_desc())}}};
  }
}

template <Which pass>
void onednn(State& state) {
  omp_set_num_threads(1);
  const ConvShape shape(state);
  const dnnl::engine engine(dnnl::engine::kind::cpu, 0);
  dnnl::stream stream(engine);
  const auto random = [&](const memory::desc& desc) {
    memory m(desc, engine);
    auto* const numbers = static_cast<float*>(m.get_data_handle());
    const Index count = static_cast<Index>(desc.get_size() / sizeof(float));
    Eigen::Map<Vector<float>>(numbers, count).setRandom();
    return m;
  };
  const auto made = primitive<pass>(engine, ConvMemory(shape), random);
  measure_flops(state, shape.flops(), [&] {
    made.first.execute(stream, made.second);
    stream.wait();
  });
}

#endif
#ifdef PHYSINV_BENCH_XSMM

/// C = A B, column-major, of the shapes of nn/forward.
void xsmm(State& state) {
  const ProductShape s(state);
  // Ours have samples contiguous: their product is this one's transpose.
  const auto kernel = libxsmm_smmdispatch(static_cast<int>(s.n),
                                          static_cast<int>(s.m),
                                          static_cast<int>(s.k),
                                          nullptr,
                                          nullptr,
                                          nullptr,
                                          nullptr,
                                          nullptr,
                                          nullptr,
                                          nullptr);
  if (kernel == nullptr) return state.SkipWithError("no kernel of this shape");
  const Batch<float> x = Batch<float>::Random(s.n, s.k);
  const Batch<float> w = Batch<float>::Random(s.k, s.m);
  Batch<float> y = Batch<float>::Zero(s.n, s.m);
  measure_flops(
      state, s.flops(), [&] { kernel(x.data(), w.data(), y.data()); });
}

#endif

std::vector<Kernel> all() {
  std::vector<std::vector<std::int64_t>> planes;
  for (const std::int64_t n : {8, 128})
    planes.insert(planes.end(),
                  {{64, 64, 16, 16, n},
                   {32, 32, 16, 16, n},
                   {64, 64, 32, 16, n},
                   {16, 16, 16, 16, n}});
  return {
      {"nn/plane/forward", planes, own<Which::forward>},
      {"nn/plane/weight_gradient", planes, own<Which::weights>},
      {"nn/plane/input_gradient", planes, own<Which::input>},
#ifdef PHYSINV_BENCH_DNNL
      {"nn/onednn/forward", planes, onednn<Which::forward>},
      {"nn/onednn/weight_gradient", planes, onednn<Which::weights>},
      {"nn/onednn/input_gradient", planes, onednn<Which::input>},
#endif
#ifdef PHYSINV_BENCH_XSMM
      {"nn/libxsmm/forward<float>", kProductShapes, xsmm},
#endif
  };
}

const bool kAdded = add_kernels(all());

}  // namespace
}  // namespace physinv::nn
