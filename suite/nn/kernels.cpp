// Single thread. Shares of peak: FLOPS over those of machine/fma<T>, the limit
// of the widest registers of this build, measured in the same run;
// machine/gemm<T> is Eigen's product, which stays with 256 bits.

#include "suite/nn/kernels.h"

#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <cstring>
#include <memory>
#include <vector>

#include "optimizers/steps/adam.h"
#include "suite/core/network.h"
#include "suite/core/simd/pack.h"
#include "suite/nn/activation.h"
#include "suite/nn/batch_norm.h"
#include "suite/nn/conv.h"
#include "suite/nn/encoding.h"
#include "suite/nn/fno.h"
#include "suite/nn/gemm.h"
#include "suite/nn/linear.h"
#include "suite/nn/mlp.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::nn {
namespace {

// ------------------------------------------------------------ the machine

template <class T>
void machine_gemm(benchmark::State& state) {
  const Index m = state.range(0), n = state.range(1), k = state.range(2);
  const Batch<T> a = Batch<T>::Random(m, k), b = Batch<T>::Random(k, n);
  Batch<T> c(m, n);
  for (auto _ : state) {
    c.noalias() = a * b;
    benchmark::DoNotOptimize(c.data());
    benchmark::ClobberMemory();
  }
  flops(state, products(m, n, k));
}

template <class T>
void machine_fma(benchmark::State& state) {
  using V = Pack<T>;
  constexpr int kChains = 24, kSteps = 1000;  // more than latency x ports
  V chain[kChains];
  for (int i = 0; i < kChains; ++i) chain[i] = broadcast<V>(T(i));
  V a = broadcast<V>(T(0.999)), b = broadcast<V>(T(1e-3));
  benchmark::DoNotOptimize(a);
  benchmark::DoNotOptimize(b);
  for (auto _ : state) {
    for (int k = 0; k < kSteps; ++k)
#pragma GCC unroll 24
      for (int i = 0; i < kChains; ++i) chain[i] = fma_lanes(chain[i], a, b);
    for (V& v : chain) benchmark::DoNotOptimize(v);
  }
  flops(state, 2.0 * kSteps * kChains * kVectorBytes / sizeof(T));
}

void machine_copy(benchmark::State& state) {
  const std::size_t bytes = std::size_t{64} << 20;
  std::vector<char> a(bytes, 1), b(bytes, 2);
  for (auto _ : state) {
    std::memcpy(b.data(), a.data(), bytes);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(2 * bytes) *
                          state.iterations());
}

BENCHMARK(machine_fma<float>)->Name("machine/fma<float>");
BENCHMARK(machine_fma<double>)->Name("machine/fma<double>");
BENCHMARK(machine_gemm<float>)
    ->Name("machine/gemm<float>")
    ->Args({1024, 1024, 1024})
    ->Args({128, 128, 128})
    ->Args({128, 8, 128});
BENCHMARK(machine_gemm<double>)
    ->Name("machine/gemm<double>")
    ->Args({1024, 1024, 1024})
    ->Args({128, 128, 128})
    ->Args({128, 8, 128});
BENCHMARK(machine_copy)->Name("machine/copy_64MiB");

// --------------------------------------------------------------- products

/// W X, with rows of W contiguous in k (forward) or in m (input gradient).
template <class T, bool kTransposed>
void product(benchmark::State& state) {
  const Index m = state.range(0), n = state.range(1), k = state.range(2);
  const Vector<T> w = Vector<T>::Random(m * k);
  LaneBlock<T> b(k, n), c(m, n);
  for (auto _ : state) {
    gemm<T>({.m = m,
             .n = b.lanes.width,
             .k = k,
             .a = w.data(),
             .a_row = kTransposed ? 1 : k,
             .a_k = kTransposed ? m : 1,
             .b = b.lanes.data,
             .b_stride = b.lanes.stride,
             .c = c.lanes.data,
             .c_stride = c.lanes.stride});
    benchmark::ClobberMemory();
  }
  flops(state, products(m, n, k));
}

template <class T>
void weight_product(benchmark::State& state) {
  const Index m = state.range(0), n = state.range(1), k = state.range(2);
  LaneBlock<T> y_bar(m, k), xt(k, n);
  Vector<T> w(m * n);
  for (auto _ : state) {
    gemm<T>({.m = m,
             .n = n,
             .k = k,
             .a = y_bar.lanes.data,
             .a_row = y_bar.lanes.stride,
             .a_k = 1,
             .b = xt.lanes.data,
             .b_stride = xt.lanes.stride,
             .c = w.data(),
             .c_stride = n});
    benchmark::ClobberMemory();
  }
  flops(state, products(m, n, k));
}

void shapes(benchmark::internal::Benchmark* b) {
  b->Args({128, 128, 128})->Args({128, 8, 128})->Args({128, 4, 128});
  b->Args({128, 128, 32})->Args({2, 128, 128})->Args({128, 128, 2});
}
void weight_shapes(benchmark::internal::Benchmark* b) {
  b->Args({128, 128, 128})->Args({128, 128, 8})->Args({128, 32, 128});
  b->Args({2, 128, 128});
}

#define PHYSINV_BENCH(T)                                                     \
  BENCHMARK((product<T, false>))->Name("nn/forward<" #T ">")->Apply(shapes); \
  BENCHMARK((product<T, true>))                                              \
      ->Name("nn/input_gradient<" #T ">")                                    \
      ->Apply(shapes);                                                       \
  BENCHMARK(weight_product<T>)                                               \
      ->Name("nn/weight_gradient<" #T ">")                                   \
      ->Apply(weight_shapes);
PHYSINV_BENCH(float)
PHYSINV_BENCH(double)
#undef PHYSINV_BENCH

// ----------------------------------------------------------------- layers

template <class T>
void run_layer(benchmark::State& state,
               std::unique_ptr<Layer<T>> layer,
               bool backward) {
  const Index n = state.range(0);
  Index size = 0;
  for (const TensorInfo& t : layer->tensors()) size += t.size;
  const Vector<T> p = Vector<T>::Random(size);
  Vector<T> p_bar(size), s(layer->state_count());
  layer->initialize_state(s.data());
  LaneBlock<T> x(layer->inputs(), n), y(layer->outputs(), n);
  LaneBlock<T> y_bar(layer->outputs(), n), x_bar(layer->inputs(), n);
  Tape tape;
  Workspace work;
  const LayerArgs<T> at{.parameters = p.data(),
                        .state = s.data(),
                        .tape = &tape,
                        .work = &work,
                        .training = true};
  layer->forward(at, x.lanes, y.lanes);
  for (auto _ : state) {
    if (backward) {
      layer->backward(at,
                      {.x = x.lanes,
                       .y = y.lanes,
                       .y_bar = y_bar.lanes,
                       .parameters_bar = p_bar.data(),
                       .x_bar = x_bar.lanes});
    } else {
      layer->forward(at, x.lanes, y.lanes);
    }
    benchmark::ClobberMemory();
  }
  flops(state, layer->operations() * double(n) * (backward ? 2 : 1));
}

using Made = std::unique_ptr<Layer<float>>;
Made linear() { return std::make_unique<Linear<float>>(128, 128); }
Made batch_norm() { return std::make_unique<BatchNorm<float>>(128); }
Made encoding() { return std::make_unique<PositionalEncoding<float>>(4, 4); }
template <Activation a>
Made activation() {
  return std::make_unique<ActivationLayer<float>>(a, 128);
}

template <Made (*make)(), bool kBackward>
void layer(benchmark::State& state) {
  run_layer<float>(state, make(), kBackward);
}

#define PHYSINV_LAYER(name, make)          \
  BENCHMARK((layer<make, false>))          \
      ->Name("nn/layer/" name "/forward")  \
      ->Arg(8)                             \
      ->Arg(128);                          \
  BENCHMARK((layer<make, true>))           \
      ->Name("nn/layer/" name "/backward") \
      ->Arg(8)                             \
      ->Arg(128);
PHYSINV_LAYER("linear", linear)
PHYSINV_LAYER("batch_norm", batch_norm)
PHYSINV_LAYER("encoding", encoding)
PHYSINV_LAYER("tanh", activation<Activation::tanh>)
PHYSINV_LAYER("softplus", activation<Activation::softplus>)
PHYSINV_LAYER("silu", activation<Activation::silu>)
#undef PHYSINV_LAYER

// --------------------------------------------------------------- networks

enum class What { forward, parameters, input, iteration, surrogate };

/// 4 -> encoding 32 -> 128-128-128 -> 2.
template <class T, What what, bool kFixed>
void network(benchmark::State& state) {
  const Index n = state.range(0);
  const auto net =
      mlp({.hidden = {128, 128, 128}, .frequencies = 4}).make<T>(4, 2);
  Vector<T> p(net->parameter_count()), p_bar(p.size()), s(0);
  net->initialize(Rng::root("kernels", 0), p, s);
  Batch<T> in = Batch<T>::Random(4, n), out(2, n), in_bar(4, n);
  in.row(0).setConstant(T(1)), in.bottomRows(2).setConstant(T(0.5));
  const Batch<T> out_bar = Batch<T>::Random(2, n) * T(1e-3);
  Tape tape;
  Workspace work;
  Adam<T> adam({.rate = 1e-9});
  VectorOut<T> p_out(p_bar);
  BatchOut<T> in_out(in_bar);
  Pass pass{.fixed_input = kFixed};
  net->forward(p, s, in, out, tape, work, pass);
  pass.same_input = what != What::surrogate;
  for (auto _ : state) {
    if (what != What::parameters && what != What::input)
      net->forward(p, s, in, out, tape, work, pass);
    if (what == What::parameters || what == What::iteration)
      net->backward(p, tape, out_bar, &p_out, nullptr, work);
    if (what == What::input || what == What::surrogate)
      net->backward(p, tape, out_bar, nullptr, &in_out, work);
    if (what == What::iteration) adam.step(p, p_bar);
    benchmark::ClobberMemory();
  }
  constexpr double passes = what == What::iteration    ? 3
                            : what == What::parameters ? 2
                            : what == What::surrogate  ? 2
                                                       : 1;
  flops(state, net->operations() * double(n) * passes);
}

void samples(benchmark::internal::Benchmark* b) {
  b->Arg(2)->Arg(8)->Arg(32)->Arg(128);
}

#define PHYSINV_NETWORK(T, what, fixed)                \
  BENCHMARK((network<T, What::what, fixed>))           \
      ->Name("nn/mlp<" #T ">/" #what "/fixed=" #fixed) \
      ->Apply(samples);
#define PHYSINV_NETWORKS(T)             \
  PHYSINV_NETWORK(T, forward, false)    \
  PHYSINV_NETWORK(T, parameters, false) \
  PHYSINV_NETWORK(T, input, false)      \
  PHYSINV_NETWORK(T, iteration, false)  \
  PHYSINV_NETWORK(T, iteration, true)   \
  PHYSINV_NETWORK(T, surrogate, false)
PHYSINV_NETWORKS(float)
PHYSINV_NETWORKS(double)
#undef PHYSINV_NETWORKS
#undef PHYSINV_NETWORK

// ---------------------------------------------------------- convolutions

/// A convolution with 3 taps, and the same products as a plain matrix product
/// on rows gathered before (im2col), the gathering included.
struct Field {
  Field(const benchmark::State& state)
      : shape{.grid = {state.range(0)},
              .in = state.range(1),
              .out = state.range(2),
              .taps = {3, 1}},
        runs(window_runs(shape.grid, shape.taps, Padding::zero)),
        n(state.range(3)),
        x(shape.positions() * shape.in, n),
        y(shape.positions() * shape.out, n),
        weights(Vector<float>::Random(shape.weights())),
        packed(shape.weights()) {}
  double flops() const {
    return 2.0 * static_cast<double>(shape.weights() * shape.positions() * n);
  }
  ConvShape shape;
  std::vector<Run> runs;
  Index n;
  LaneBlock<float> x, y;
  Vector<float> weights, packed;
};

void conv_forward(benchmark::State& state) {
  Field f(state);
  for (auto _ : state) {
    pack_weights(f.shape, f.weights.data(), f.packed.data());
    convolve<float>(f.shape,
                    f.runs,
                    f.packed.data(),
                    nullptr,
                    f.x.lanes,
                    f.y.lanes,
                    0,
                    f.shape.positions());
    benchmark::ClobberMemory();
  }
  flops(state, f.flops());
}

void conv_weights(benchmark::State& state) {
  Field f(state);
  Workspace work;
  for (auto _ : state) {
    const Workspace::Scope scope(work);
    const WeightSums<float> sums(f.shape, 1, true, work);
    accumulate_weights<float>(f.shape,
                              f.runs,
                              f.x.lanes,
                              f.y.lanes,
                              0,
                              f.shape.positions(),
                              sums.begin(0));
    sums.end(0);
    sums.finish(f.weights.data());
    benchmark::ClobberMemory();
  }
  flops(state, f.flops());
}

/// One `gemm` per position on shifted rows.
void conv_shifted_gemm(benchmark::State& state) {
  Field f(state);
  const Index depth = f.shape.depth();
  for (auto _ : state) {
    for (Index p = 0; p < f.shape.positions(); ++p) {
      const Index skip = p == 0 ? f.shape.in : 0;
      const Index end = p + 1 == f.shape.positions() ? f.shape.in : 0;
      gemm<float>({.m = f.shape.out,
                   .n = f.x.lanes.width,
                   .k = depth - skip - end,
                   .a = f.weights.data() + skip,
                   .a_row = depth,
                   .a_k = 1,
                   .b = f.x.lanes.row((p - 1) * f.shape.in + skip),
                   .b_stride = f.x.lanes.stride,
                   .c = f.y.lanes.row(p * f.shape.out),
                   .c_stride = f.y.lanes.stride});
    }
    benchmark::ClobberMemory();
  }
  flops(state, f.flops());
}

/// Gathered to [channel and tap][position and sample], one product for all.
void conv_im2col(benchmark::State& state) {
  Field f(state);
  const Index width = f.x.lanes.width, columns = f.shape.positions() * width;
  const Index depth = f.shape.depth(), in = f.shape.in;
  Batch<float> gathered = Batch<float>::Zero(columns, depth);
  Batch<float> out(columns, f.shape.out);
  for (auto _ : state) {
    for (Index k = 0; k < depth; ++k)
      for (Index p = 0; p < f.shape.positions(); ++p) {
        const Index from = p + k / in - 1;
        if (from < 0 || from >= f.shape.positions()) continue;
        const float* row = f.x.lanes.row(from * in + k % in);
        std::copy(row, row + width, gathered.col(k).data() + p * width);
      }
    gemm<float>({.m = f.shape.out,
                 .n = columns,
                 .k = depth,
                 .a = f.weights.data(),
                 .a_row = depth,
                 .a_k = 1,
                 .b = gathered.data(),
                 .b_stride = columns,
                 .c = out.data(),
                 .c_stride = columns});
    benchmark::ClobberMemory();
  }
  flops(state, f.flops());
}

void conv_shapes(benchmark::internal::Benchmark* b) {
  for (const std::int64_t n : {8, 128}) {
    b->Args({256, 1, 16, n})->Args({128, 16, 16, n})->Args({16, 64, 64, n});
    b->Args({256, 32, 16, n});
  }
}
BENCHMARK(conv_forward)->Name("nn/conv/forward")->Apply(conv_shapes);
BENCHMARK(conv_weights)->Name("nn/conv/weight_gradient")->Apply(conv_shapes);
BENCHMARK(conv_shifted_gemm)
    ->Name("nn/conv/forward_by_gemm_per_position")
    ->Apply(conv_shapes);
BENCHMARK(conv_im2col)->Name("nn/conv/forward_by_im2col")->Apply(conv_shapes);

enum class Step { forward, training, input, gauss_newton, hessian };

/// As the experiments train them.
template <class T, Step step>
void field_network(benchmark::State& state,
                   const NetworkRecipe& recipe,
                   Index inputs,
                   Index outputs) {
  const Index n = state.range(0);
  const auto net = recipe.make<T>(inputs, outputs);
  Vector<T> p(net->parameter_count()), p_bar(p.size()), s(net->state_count());
  net->initialize(Rng::root("kernels", 0), p, s);
  const Batch<T> in = Batch<T>::Random(inputs, n);
  const Batch<T> out_bar = Batch<T>::Random(outputs, n);
  Batch<T> out(outputs, n), in_bar(inputs, n);
  Tape tape;
  Workspace work;
  VectorOut<T> p_out(p_bar);
  BatchOut<T> in_out(in_bar);
  Pass pass{.training = step != Step::input};
  net->forward(p, s, in, out, tape, work, pass);
  pass.same_input = step == Step::training;
  // Products at one point: only they are timed.
  constexpr bool kProduct = step == Step::gauss_newton || step == Step::hessian;
  const Vector<T> p_dot = Vector<T>::Random(p.size());
  const Batch<T> no_input(inputs, 0);
  Batch<T> out_dot(outputs, n);
  Tape dots;
  for (auto _ : state) {
    if (kProduct) net->tangent(p, tape, p_dot, no_input, out_dot, dots, work);
    if (step == Step::gauss_newton)
      net->backward(p, tape, out_dot, &p_out, nullptr, work);
    if (step == Step::hessian)
      net->backward_tangent(
          p, tape, p_dot, dots, out_bar, out_dot, nullptr, p_bar, work);
    if (kProduct) continue;
    net->forward(p, s, in, out, tape, work, pass);
    if (step == Step::training)
      net->backward(p, tape, out_bar, &p_out, nullptr, work);
    if (step == Step::input)
      net->backward(p, tape, out_bar, nullptr, &in_out, work);
    benchmark::ClobberMemory();
  }
  const double passes = step == Step::forward        ? 1
                        : step == Step::training     ? 3
                        : step == Step::gauss_newton ? 4
                        : step == Step::hessian      ? 8
                                                     : 2;
  flops(state, net->operations() * double(n) * passes);
}

template <class T, Step step>
void packet_vgg(benchmark::State& state) {
  field_network<T, step>(state,
                         vgg({.channels = 1,
                              .grid = {256},
                              .features = {16, 16, 16, 16, 16},
                              .hidden = {64, 32}}),
                         256,
                         1);
}
template <class T, Step step>
void ks_vgg(benchmark::State& state) {
  field_network<T, step>(state,
                         vgg({.channels = 2,
                              .grid = {128},
                              .features = {32, 32, 64, 64},
                              .hidden = {64, 64}}),
                         256,
                         2);
}
template <class T, Step step>
void packet_unet(benchmark::State& state) {
  field_network<T, step>(
      state, unet({.grid = {256}, .scalars_before = 1}), 257, 256);
}
template <class T, Step step>
void ks_unet(benchmark::State& state) {
  field_network<T, step>(
      state, unet({.grid = {128}, .scalars_after = 2}), 130, 128);
}
template <class T, Step step>
void plane_unet(benchmark::State& state) {
  field_network<T, step>(state,
                         unet({.grid = {64, 64},
                               .padding = Padding::circular,
                               .batch_statistics = true}),
                         64 * 64,
                         64 * 64);
}

template <class T, Step step>
void plane_fno(benchmark::State& state) {
  field_network<T, step>(state, fno({.grid = {64, 64}}), 64 * 64, 64 * 64);
}

#define PHYSINV_FIELD_NETWORK(T, name, step) \
  BENCHMARK((name<T, Step::step>))           \
      ->Name("nn/" #name "<" #T ">/" #step)  \
      ->Arg(8)                               \
      ->Arg(32)                              \
      ->Arg(128)                             \
      ->Arg(256);
#define PHYSINV_FIELD_NETWORKS(T, name)    \
  PHYSINV_FIELD_NETWORK(T, name, forward)  \
  PHYSINV_FIELD_NETWORK(T, name, training) \
  PHYSINV_FIELD_NETWORK(T, name, input)
PHYSINV_FIELD_NETWORKS(float, packet_vgg)
PHYSINV_FIELD_NETWORKS(float, ks_vgg)
PHYSINV_FIELD_NETWORKS(float, packet_unet)
PHYSINV_FIELD_NETWORKS(float, ks_unet)
PHYSINV_FIELD_NETWORKS(float, plane_unet)
PHYSINV_FIELD_NETWORK(float, plane_unet, gauss_newton)
PHYSINV_FIELD_NETWORK(float, plane_unet, hessian)
PHYSINV_FIELD_NETWORKS(float, plane_fno)
PHYSINV_FIELD_NETWORK(double, packet_vgg, training)
PHYSINV_FIELD_NETWORK(double, packet_unet, training)
#undef PHYSINV_FIELD_NETWORKS
#undef PHYSINV_FIELD_NETWORK

template <class T>
void adam_step(benchmark::State& state) {
  Vector<T> x = Vector<T>::Random(37506);
  const Vector<T> g = Vector<T>::Random(x.size());
  Adam<T> adam;
  for (auto _ : state) {
    adam.step(x, g);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * x.size() *
                          static_cast<std::int64_t>(7 * sizeof(T)));
}
BENCHMARK(adam_step<float>)->Name("steps/adam<float>/37506");
BENCHMARK(adam_step<double>)->Name("steps/adam<double>/37506");

}  // namespace
}  // namespace physinv::nn
