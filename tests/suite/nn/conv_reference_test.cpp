// The convolutional networks' part of the independent vectors. The physics is
// not needed: the files hold the cotangents that it hands to the network.

#include <gtest/gtest.h>

#include <cmath>

#include "optimizers/steps/adam.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"
#include "tests/suite/nn/nn_testing.h"
#include "tests/support/formula_weights.h"
#include "tests/support/reference.h"

namespace physinv::nn {
namespace {

using test::columns;
using test::Comparator;
using test::Json;

constexpr const char* kPacket = "jpo-wave-packet";
constexpr const char* kKs = "jpo-kuramoto-sivashinsky";

Json entry(const char* id, const char* name) {
  const auto all = test::reference_entries(id, name);
  EXPECT_EQ(all.size(), 1U) << id << " " << name;
  return all.at(0);
}

template <class T>
Comparator comparator(const Json& e) {
  return sizeof(T) == 4 ? Comparator(1e-4, 0) : test::EntryTolerance(e).array();
}

template <class T>
void use_formula(Bench<T>& b,
                 const test::TensorNumbers& numbers,
                 const Json& e,
                 double last) {
  test::formula_weights<T>(
      b.net->tensors(), numbers, e.value("shift", 0.0), last, b.p);
}

/// Tensors of the file whose gradient is exactly zero: biases in front of a
/// batch normalisation. What is stored of them is noise.
template <class T>
bool is_noise(const Bench<T>& b, std::size_t t) {
  const auto& all = b.net->tensors();
  return all[t].kind == 'b' && t + 1 < all.size() && all[t + 1].kind == 's' &&
         all[t - 1].kind == 'k';
}

template <class T>
Vector<double> norms(const Bench<T>& b, const Vector<T>& bar) {
  const auto& all = b.net->tensors();
  Vector<double> n(Index(all.size()));
  for (std::size_t t = 0; t < all.size(); ++t)
    n(Index(t)) =
        bar.segment(all[t].offset, all[t].size).template cast<double>().norm();
  return n;
}

template <class T>
void expect_gradients(const Bench<T>& b,
                      const Vector<T>& bar,
                      const Json& step,
                      const Comparator& same) {
  const Vector<double> n = norms(b, bar);
  Vector<double> stored = test::vector(step["weight_grad_norm_per_tensor"]);
  const double zero = (sizeof(T) == 4 ? 1e-6 : 1e-8) * stored.maxCoeff();
  ASSERT_EQ(n.size(), stored.size());
  for (std::size_t t = 0; t < b.net->tensors().size(); ++t) {
    const TensorInfo& info = b.net->tensors()[t];
    if (is_noise(b, t)) {
      EXPECT_LE(n(Index(t)), zero) << info.name;
      stored(Index(t)) = n(Index(t));
      continue;
    }
    const Vector<double> first =
        test::vector(step["weight_grad_first_entries"][t]);
    const auto part = bar.segment(info.offset, info.size);
    EXPECT_TRUE(Comparator(0, same.rtol() * part.cwiseAbs().maxCoeff())(
        part.head(first.size()), first))
        << info.name;
  }
  EXPECT_TRUE(same(n, stored));
}

/// Steps of joint optimization: the file's clipped cotangents, `scale` times,
/// go back through the network and Adam moves it. In float, the first step,
/// its gradients to `single`.
template <class T>
void run_steps(Bench<T>& b,
               const Json& e,
               const Batch<T>& in,
               double scale,
               double last,
               double single) {
  const Comparator same = comparator<T>(e);
  const Comparator same_gradients =
      sizeof(T) == 4 ? Comparator(single, 0) : same;
  use_formula(b, test::numbers_in_order(b.net->tensors().size()), e, last);
  Adam<T> adam({.rate = 1e-3});
  Pass pass{.training = true};
  for (const Json& step : e["steps"]) {
    SCOPED_TRACE("step " + step["step"].dump());
    const Batch<T> out = b.forward(in, pass);
    b.net->update_state(b.tape, b.s);
    EXPECT_TRUE(same(out, columns(step["net_output"])));
    if (!step.contains("grad_clipped")) return;
    const Batch<double> bar = scale * columns(step["grad_clipped"]);
    const Vector<T> g = b.parameters_bar(bar.template cast<T>());
    expect_gradients(b, g, step, same_gradients);
    if (sizeof(T) == 4) return;
    adam.step(b.p, g);
    pass.same_input = true;
  }
}

template <class T>
class ConvReference : public testing::Test {};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(ConvReference, Types);

TYPED_TEST(ConvReference, WavePacketClassifier) {
  using T = TypeParam;
  const Batch<T> in =
      columns(entry(kPacket, "observations")["y"]).template cast<T>();
  Bench<T> b(vgg({.channels = 1,
                  .grid = {256},
                  .features = {16, 16, 16, 16, 16},
                  .hidden = {64, 32}}),
             256,
             1);
  ASSERT_EQ(b.p.size(), 13921);
  run_steps(b, entry(kPacket, "jpo_g2s"), in, 1, 1, 1e-4);
  if (sizeof(T) == 4) return;
  const Json eval = entry(kPacket, "g2s_eval");
  EXPECT_TRUE(comparator<T>(eval)(b.forward(in), columns(eval["output"])));
}

TYPED_TEST(ConvReference, KuramotoSivashinskyClassifier) {
  using T = TypeParam;
  const Json problems = entry(kKs, "problems");
  const Batch<double> u0 = columns(problems["u0"]),
                      ut = columns(problems["uT"]);
  Batch<T> in(256, u0.cols());
  in << u0.cast<T>(), ut.cast<T>();
  Bench<T> b(vgg({.channels = 2,
                  .grid = {128},
                  .features = {32, 32, 64, 64},
                  .hidden = {64, 64}}),
             256,
             2);
  ASSERT_EQ(b.p.size(), 59650);
  // (alpha, beta) = 1 + output / 4. Three samples leave one free dimension
  // behind each dense normalisation: float32 gradients of this experiment are
  // good to 1e-2 (PyTorch's are off by 3e-4 of the largest norm here).
  run_steps(b, entry(kKs, "jpo_g2s"), in, 0.25, 0.1, 1e-2);
}

/// Output, loss and gradients of a sum-of-squares loss, in training mode.
template <class T>
void expect_training(Bench<T>& b,
                     const Json& e,
                     const std::string& prefix,
                     const Batch<T>& in,
                     const Batch<double>& target) {
  const Comparator same = comparator<T>(e);
  const auto numbers = test::unet_numbers(4);
  ASSERT_EQ(b.net->tensors().size(), numbers.size());
  use_formula(b, numbers, e, 1);
  const Batch<double> out =
      b.forward(in, {.training = true}).template cast<double>();
  b.net->update_state(b.tape, b.s);
  EXPECT_TRUE(same(out.topRows(8), columns(e[prefix + "output_first8"])));
  EXPECT_TRUE(same(out.colwise().sum().transpose(),
                   test::vector(e[prefix + "output_sum"])));
  const Batch<double> off = out - target;
  // Without the usual half.
  EXPECT_TRUE(same(off.squaredNorm(), e[prefix + "loss"].get<double>()));
  const Vector<double> n =
      norms(b, b.parameters_bar((2 * off).template cast<T>()));
  const Vector<double> stored = test::vector(e["grad_norms"]);
  Vector<double> ordered(n.size());
  const double zero = (sizeof(T) == 4 ? 1e-6 : 1e-8) * stored.maxCoeff();
  for (std::size_t t = 0; t < numbers.size(); ++t) {
    const Index at = Index(numbers[t]);
    ordered(at) = n(Index(t));
    if (!is_noise(b, t)) continue;
    EXPECT_LE(n(Index(t)), zero);
    ordered(at) = stored(at);
  }
  EXPECT_TRUE(same(ordered, stored));
}

TYPED_TEST(ConvReference, WavePacketSurrogate) {
  using T = TypeParam;
  const Json e = entry(kPacket, "surrogate_unet");
  const Batch<double> y = columns(entry(kPacket, "observations")["y"]);
  Bench<T> b(
      unet({.grid = {256}, .channels = 1, .scalars_before = 1}), 257, 256);
  ASSERT_EQ(b.p.size(), 13073);
  Batch<T> in(257, y.cols());
  in << columns(e["xi"]).template cast<T>(),
      columns(e["eps"]).template cast<T>();
  expect_training(b, e, "train_", in, y);

  in.bottomRows(256).setZero();
  const Comparator same = comparator<T>(e);
  const Batch<double> off = b.forward(in).template cast<double>() - y;
  EXPECT_TRUE(same(0.5 * off.colwise().squaredNorm().transpose(),
                   test::vector(e["eval_loss"])));
  const Batch<T> in_bar = b.in_bar(off.template cast<T>());
  EXPECT_TRUE(same(in_bar.topRows(1), columns(e["eval_grad_xi"])));
}

TYPED_TEST(ConvReference, KuramotoSivashinskySurrogate) {
  using T = TypeParam;
  const Json problems = entry(kKs, "problems");
  const Batch<double> u0 = columns(problems["u0"]);
  Batch<T> in(130, u0.cols());
  in << u0.cast<T>(), columns(problems["true"]).template cast<T>();
  Bench<T> b(unet({.grid = {128},
                   .channels = 1,
                   .scalars_after = 2,
                   .scalar_shift = 1,
                   .scalar_unit = 0.25}),
             130,
             128);
  ASSERT_EQ(b.p.size(), 13121);
  expect_training(
      b, entry(kKs, "surrogate_unet"), "", in, columns(problems["uT"]));
}

}  // namespace
}  // namespace physinv::nn
