// Single thread. Shares of peak: FLOPS over those of machine/fma<T>, the limit
// of the widest registers of this build, measured in the same run.

#include "suite/nn/kernels.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstring>
#include <functional>
#include <span>
#include <string>
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

using benchmark::State;

// ------------------------------------------------------------ the machine

template <class T>
void machine_fma(State& state) {
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
  count_rate(state, "FLOPS", 2.0 * kSteps * kChains * kLanes<T>);
}

void machine_copy(State& state) {
  const std::size_t bytes = std::size_t{64} << 20;
  std::vector<char> a(bytes, 1), b(bytes, 2);
  measure(state, [&] { std::memcpy(b.data(), a.data(), bytes); });
  state.SetBytesProcessed(static_cast<std::int64_t>(2 * bytes) *
                          state.iterations());
}

// --------------------------------------------------------------- products

/// W X, with rows of W contiguous in k (forward) or in m (input gradient).
template <class T, bool kTransposed>
void product(State& state) {
  const ProductShape s(state);
  const Vector<T> w = Vector<T>::Random(s.m * s.k);
  RandomRows<T> b(s.k, s.n), c(s.m, s.n);
  measure_flops(state, s.flops(), [&] {
    gemm<T>({.m = s.m,
             .n = b.width,
             .k = s.k,
             .a = w.data(),
             .a_row = kTransposed ? 1 : s.k,
             .a_k = kTransposed ? s.m : 1,
             .b = b.data,
             .b_stride = b.stride,
             .c = c.data,
             .c_stride = c.stride});
  });
}

template <class T>
void weight_product(State& state) {
  const ProductShape s(state);
  RandomRows<T> y_bar(s.m, s.k), xt(s.k, s.n);
  Vector<T> w(s.m * s.n);
  measure_flops(state, s.flops(), [&] {
    gemm<T>({.m = s.m,
             .n = s.n,
             .k = s.k,
             .a = y_bar.data,
             .a_row = y_bar.stride,
             .a_k = 1,
             .b = xt.data,
             .b_stride = xt.stride,
             .c = w.data(),
             .c_stride = s.n});
  });
}

// ----------------------------------------------------------------- layers

void run_layer(State& state, const Layer<float>& layer, bool backward) {
  const Index n = state.range(0);
  Index size = 0;
  for (const TensorInfo& t : layer.tensors()) size += t.size;
  const Vector<float> p = Vector<float>::Random(size);
  Vector<float> p_bar(size), s(layer.state_count());
  layer.initialize_state(s.data());
  RandomRows<float> x(layer.inputs(), n), y(layer.outputs(), n);
  RandomRows<float> y_bar(layer.outputs(), n), x_bar(layer.inputs(), n);
  Tape tape;
  Workspace work;
  const Run<float> at({.parameters = p.data(), .work = &work, .training = true},
                      tape,
                      s.data());
  layer.forward(at, x, y);
  const double flops = layer.operations() * double(n) * (backward ? 2 : 1);
  measure_flops(state, flops, [&] {
    if (!backward) return layer.forward(at, x, y);
    layer.backward(at,
                   {.x = x,
                    .y = y,
                    .y_bar = y_bar,
                    .parameters_bar = p_bar.data(),
                    .x_bar = x_bar});
  });
}

void add_layer(std::vector<Kernel>& to,
               std::string_view name,
               const std::function<LayerPointer<float>()>& make) {
  for (const bool backward : {false, true})
    to.push_back(
        {fmt::format("nn/layer/{}/{}", name, backward ? "backward" : "forward"),
         {{8}, {128}},
         [=](State& state) { run_layer(state, *make(), backward); }});
}

// --------------------------------------------------------------- networks

/// What an iteration consists of.
enum : unsigned {
  kTraining = 1,
  kSameInput = 2,
  kFixedInput = 4,
  kForward = 8,
  kParameters = 16,
  kInput = 32,
  kAdam = 64,
  kTangent = 128,
  kHessian = 256,
};
struct Step {
  const char* name;
  double passes;  ///< cost in forward passes
  unsigned what;
};

constexpr Step kDenseSteps[] = {
    {"forward", 1, kSameInput | kForward},
    {"parameters", 2, kParameters},
    {"input", 1, kInput},
    {"iteration", 3, kSameInput | kForward | kParameters | kAdam},
    {"iteration", 3, kSameInput | kFixedInput | kForward | kParameters | kAdam},
    {"surrogate", 2, kForward | kInput}};

/// As the experiments train networks on fields; then products at one point, of
/// which only they are timed.
constexpr Step kFieldSteps[] = {
    {"forward", 1, kTraining | kForward},
    {"training", 3, kTraining | kSameInput | kForward | kParameters},
    {"input", 2, kForward | kInput},
    {"gauss_newton", 4, kTraining | kTangent | kParameters},
    {"hessian", 8, kTraining | kTangent | kHessian}};

struct Sized {
  const char* name;
  Index inputs, outputs;
  NetworkRecipe recipe;
};

template <class T>
void run_network(State& state, const Sized& sized, const Step& step) {
  const auto has = [what = step.what](unsigned part) { return what & part; };
  const Index n = state.range(0), inputs = sized.inputs;
  const auto net = sized.recipe.make<T>(inputs, sized.outputs);
  Vector<T> p(net->parameter_count()), p_bar(p.size()), s(net->state_count());
  net->initialize(Rng::root("kernels", 0), p, s);
  Batch<T> in = Batch<T>::Random(inputs, n), in_bar(inputs, n);
  if (has(kFixedInput))
    in.row(0).setConstant(T(1)), in.bottomRows(2).setConstant(T(0.5));
  const Batch<T> out_bar = Batch<T>::Random(sized.outputs, n) * T(1e-3);
  const Vector<T> p_dot = Vector<T>::Random(p.size());
  const Batch<T> no_input(inputs, 0);
  Batch<T> out(sized.outputs, n), out_dot(sized.outputs, n);
  Tape tape, dots;
  Workspace work;
  Adam<T> adam({.rate = 1e-9});
  VectorOut<T> p_out(p_bar);
  BatchOut<T> in_out(in_bar);
  Pass pass{.training = has(kTraining) != 0,
            .fixed_input = has(kFixedInput) != 0};
  net->forward(p, s, in, out, tape, work, pass);
  pass.same_input = has(kSameInput) != 0;
  measure_flops(state, net->operations() * double(n) * step.passes, [&] {
    if (has(kForward)) net->forward(p, s, in, out, tape, work, pass);
    if (has(kTangent))
      net->tangent(p, tape, p_dot, no_input, out_dot, dots, work);
    if (has(kParameters))
      net->backward(
          p, tape, has(kTangent) ? out_dot : out_bar, &p_out, nullptr, work);
    if (has(kInput)) net->backward(p, tape, out_bar, nullptr, &in_out, work);
    if (has(kHessian))
      net->backward_tangent(
          p, tape, p_dot, dots, out_bar, out_dot, nullptr, p_bar, work);
    if (has(kAdam)) adam.step(p, p_bar);
  });
}

/// 4 -> encoding 32 -> 128-128-128 -> 2.
template <class T>
void add_mlp(std::vector<Kernel>& to, const char* type) {
  const Sized sized{
      "mlp", 4, 2, mlp({.hidden = {128, 128, 128}, .frequencies = 4})};
  for (const Step& step : kDenseSteps)
    to.push_back({fmt::format("nn/mlp<{}>/{}/fixed={}",
                              type,
                              step.name,
                              (step.what & kFixedInput) != 0),
                  {{2}, {8}, {32}, {128}},
                  [=](State& state) { run_network<T>(state, sized, step); }});
}

template <class T>
void add_field_network(std::vector<Kernel>& to,
                       const char* type,
                       const Sized& sized,
                       std::span<const Step> steps) {
  for (const Step& step : steps)
    to.push_back({fmt::format("nn/{}<{}>/{}", sized.name, type, step.name),
                  {{8}, {32}, {128}, {256}},
                  [=](State& state) { run_network<T>(state, sized, step); }});
}

void add_field_networks(std::vector<Kernel>& to) {
  const Index plane = 64 * 64;
  const VggOptions packet{.channels = 1,
                          .grid = {256},
                          .features = {16, 16, 16, 16, 16},
                          .hidden = {64, 32}};
  const VggOptions ks{.channels = 2,
                      .grid = {128},
                      .features = {32, 32, 64, 64},
                      .hidden = {64, 64}};
  const UnetOptions on_plane{
      .grid = {64, 64}, .padding = Padding::circular, .batch_statistics = true};
  const Sized all[] = {
      {"packet_vgg", 256, 1, vgg(packet)},
      {"ks_vgg", 256, 2, vgg(ks)},
      {"packet_unet", 257, 256, unet({.grid = {256}, .scalars_before = 1})},
      {"ks_unet", 130, 128, unet({.grid = {128}, .scalars_after = 2})},
      {"plane_unet", plane, plane, unet(on_plane)},
      {"plane_fno", plane, plane, fno({.grid = {64, 64}})}};
  const std::span steps(kFieldSteps);
  for (std::size_t i = 0; i < 6; ++i)
    add_field_network<float>(to, "float", all[i], steps.first(i == 4 ? 5 : 3));
  for (const std::size_t i : {0, 2})
    add_field_network<double>(to, "double", all[i], steps.subspan(1, 1));
}

// ---------------------------------------------------------- convolutions

/// A convolution with 3 taps, and the same products as a plain matrix product
/// on rows gathered before (im2col), the gathering included.
struct Field {
  Field(const State& state)
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
  std::vector<WindowRun> runs;
  Index n;
  RandomRows<float> x, y;
  Vector<float> weights, packed;
};

void conv_forward(State& state) {
  Field f(state);
  measure_flops(state, f.flops(), [&] {
    pack_weights(f.shape, f.weights.data(), f.packed.data());
    convolve<float>(f.shape,
                    f.runs,
                    f.packed.data(),
                    nullptr,
                    f.x,
                    f.y,
                    0,
                    f.shape.positions());
  });
}

void conv_weights(State& state) {
  Field f(state);
  Workspace work;
  measure_flops(state, f.flops(), [&] {
    const Workspace::Scope scope(work);
    const WeightSums<float> sums(f.shape, 1, true, work);
    accumulate_weights<float>(
        f.shape, f.runs, f.x, f.y, 0, f.shape.positions(), sums.begin(0));
    sums.end(0);
    sums.finish(f.weights.data());
  });
}

/// One `gemm` per position on shifted rows.
void conv_shifted_gemm(State& state) {
  Field f(state);
  const Index depth = f.shape.depth();
  measure_flops(state, f.flops(), [&] {
    for (Index p = 0; p < f.shape.positions(); ++p) {
      const Index skip = p == 0 ? f.shape.in : 0;
      const Index end = p + 1 == f.shape.positions() ? f.shape.in : 0;
      gemm<float>({.m = f.shape.out,
                   .n = f.x.width,
                   .k = depth - skip - end,
                   .a = f.weights.data() + skip,
                   .a_row = depth,
                   .a_k = 1,
                   .b = f.x.row((p - 1) * f.shape.in + skip),
                   .b_stride = f.x.stride,
                   .c = f.y.row(p * f.shape.out),
                   .c_stride = f.y.stride});
    }
  });
}

/// Gathered to [channel and tap][position and sample], one product for all.
void conv_im2col(State& state) {
  Field f(state);
  const Index width = f.x.width, columns = f.shape.positions() * width;
  const Index depth = f.shape.depth(), in = f.shape.in;
  Batch<float> gathered = Batch<float>::Zero(columns, depth);
  Batch<float> out(columns, f.shape.out);
  measure_flops(state, f.flops(), [&] {
    for (Index k = 0; k < depth; ++k)
      for (Index p = 0; p < f.shape.positions(); ++p) {
        const Index from = p + k / in - 1;
        if (from < 0 || from >= f.shape.positions()) continue;
        std::copy_n(f.x.row(from * in + k % in),
                    width,
                    gathered.col(k).data() + p * width);
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
  });
}

template <class T>
void adam_step(State& state) {
  Vector<T> x = Vector<T>::Random(37506);
  const Vector<T> g = Vector<T>::Random(x.size());
  Adam<T> adam;
  measure(state, [&] { adam.step(x, g); });
  state.SetBytesProcessed(state.iterations() * x.size() *
                          static_cast<std::int64_t>(7 * sizeof(T)));
}

// ------------------------------------------------------------- the table

template <class T>
void add_products(std::vector<Kernel>& to, const std::string& type) {
  to.push_back({"nn/forward" + type, kProductShapes, product<T, false>});
  to.push_back({"nn/input_gradient" + type, kProductShapes, product<T, true>});
  to.push_back({"nn/weight_gradient" + type,
                {{128, 128, 128}, {128, 128, 8}, {128, 32, 128}, {2, 128, 128}},
                weight_product<T>});
}

std::vector<Kernel> all() {
  std::vector<Kernel> all = {{"machine/fma<float>", {}, machine_fma<float>},
                             {"machine/fma<double>", {}, machine_fma<double>},
                             {"machine/copy_64MiB", {}, machine_copy}};
  add_products<float>(all, "<float>");
  add_products<double>(all, "<double>");
  add_layer(all, "linear", [] { return linear<float>(128, 128); });
  add_layer(all, "batch_norm", [] { return batch_norm<float>(128); });
  add_layer(all, "encoding", [] { return positional_encoding<float>(4, 4); });
  for (const Activation a :
       {Activation::tanh, Activation::softplus, Activation::silu})
    add_layer(
        all, to_string(a), [=] { return activation_layer<float>(a, 128); });
  add_mlp<float>(all, "float");
  add_mlp<double>(all, "double");
  std::vector<std::vector<std::int64_t>> fields;
  for (const std::int64_t n : {8, 128})
    fields.insert(
        fields.end(),
        {{256, 1, 16, n}, {128, 16, 16, n}, {16, 64, 64, n}, {256, 32, 16, n}});
  all.push_back({"nn/conv/forward", fields, conv_forward});
  all.push_back({"nn/conv/weight_gradient", fields, conv_weights});
  all.push_back(
      {"nn/conv/forward_by_gemm_per_position", fields, conv_shifted_gemm});
  all.push_back({"nn/conv/forward_by_im2col", fields, conv_im2col});
  add_field_networks(all);
  all.push_back({"steps/adam<float>/37506", {}, adam_step<float>});
  all.push_back({"steps/adam<double>/37506", {}, adam_step<double>});
  return all;
}

const bool kAdded = add_kernels(all());

}  // namespace
}  // namespace physinv::nn
