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

template <class T>
Comparator comparator(const Json& e) {
  return sizeof(T) == 4 ? Comparator(1e-4, 0) : test::EntryTolerance(e).array();
}

template <class T>
void use_formula(Bench<T>& b,
                 const test::TensorNumbers& numbers,
                 double shift,
                 double last) {
  test::formula_weights<T>(b.net->tensors(), numbers, shift, last, b.p);
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
  Vector<double> stored =
      test::vector(step["weight_grad_norm_per_tensor"], n.size());
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
    ASSERT_LE(first.size(), info.size);
    const auto part = bar.segment(info.offset, info.size);
    EXPECT_TRUE(Comparator(0, same.rtol() * part.cwiseAbs().maxCoeff())(
        part.head(first.size()), first))
        << info.name;
  }
  EXPECT_TRUE(same(n, stored));
}

/// What the specification says, where the entry says nothing else.
struct Steps {
  double scale = 1, last_matrix = 1;
  double single = 1e-4;  ///< gradients in float
};

/// Steps of joint optimization: the file's clipped cotangents, `scale` times,
/// go back through the network and Adam moves it. In float, the first step.
template <class T>
void run_steps(Bench<T>& b,
               const char* id,
               const Json& e,
               const Batch<T>& in,
               const Steps& about) {
  test::expect_parameters(e, b.p.size());
  const double scale = test::setting(e, "output_scale", "= 1 \\+", about.scale);
  const double last =
      test::setting(e,
                    "last_matrix",
                    "last weight matrix (?:multiplied by|times)",
                    about.last_matrix);
  const Comparator same = comparator<T>(e);
  const Comparator same_gradients =
      sizeof(T) == 4 ? Comparator(about.single, 0) : same;
  use_formula(b,
              test::numbers_in_order(b.net->tensors().size()),
              test::formula_shift(id, e),
              last);
  Adam<T> adam({.rate = test::setting(e, "lr", "lr", 1e-3)});
  Pass pass{.training = true};
  for (const Json& step : e.at("steps")) {
    SCOPED_TRACE("step " + step["step"].dump());
    step.items();  // losses and gradients are read by the problems' own tests
    const Batch<T> out = b.forward(in, pass);
    b.net->update_state(b.tape, b.s);
    EXPECT_TRUE(same(out, columns(step["net_output"])));
    if (!step.contains("grad_clipped")) return;
    const Batch<double> bar =
        scale * columns(step["grad_clipped"], out.rows(), out.cols());
    const Vector<T> g = b.parameters_bar(bar.template cast<T>());
    expect_gradients(b, g, step, same_gradients);
    if (sizeof(T) == 4) return;
    adam.step(b.p, g);
    pass.same_input = true;
  }
}

Batch<double> signals() {
  return columns(test::spoken_of(kPacket, "observations").at("y"));
}

template <class T>
void check_packet_classifier(const Json& e) {
  const Batch<T> in = signals().template cast<T>();
  Bench<T> b(vgg({.channels = 1,
                  .grid = {in.rows()},
                  .features = {16, 16, 16, 16, 16},
                  .hidden = {64, 32}}),
             in.rows(),
             1);
  run_steps(b, kPacket, e, in, {});
  if (sizeof(T) == 4) return;
  // The same network after those steps.
  const Json eval = test::spoken_of(kPacket, "g2s_eval");
  EXPECT_TRUE(comparator<T>(eval)(b.forward(in), columns(eval["output"])));
}

template <class T>
void check_ks_classifier(const Json& e) {
  const Json problems = test::spoken_of(kKs, "problems");
  const Batch<double> u0 = columns(problems["u0"]),
                      ut = columns(problems["uT"], u0.rows(), u0.cols());
  Batch<T> in(u0.rows() + ut.rows(), u0.cols());
  in << u0.cast<T>(), ut.cast<T>();
  Bench<T> b(vgg({.channels = 2,
                  .grid = {u0.rows()},
                  .features = {32, 32, 64, 64},
                  .hidden = {64, 64}}),
             in.rows(),
             2);
  // (alpha, beta) = 1 + output / 4. Three samples leave one free dimension
  // behind each dense normalisation: float32 gradients of this experiment are
  // good to 1e-2 (PyTorch's are off by 3e-4 of the largest norm here).
  run_steps(b, kKs, e, in, {.scale = 0.25, .last_matrix = 0.1, .single = 1e-2});
}

/// Output, loss and gradients of a sum-of-squares loss, in training mode.
template <class T>
void expect_training(Bench<T>& b,
                     const char* id,
                     const Json& e,
                     const std::string& prefix,
                     const Batch<T>& in,
                     const Batch<double>& target) {
  const Comparator same = comparator<T>(e);
  const auto numbers = test::unet_numbers(4);
  ASSERT_EQ(b.net->tensors().size(), numbers.size());
  test::expect_parameters(e, b.p.size());
  use_formula(b, numbers, test::formula_shift(id, e), 1);
  const Batch<double> out =
      b.forward(in, {.training = true}).template cast<double>();
  b.net->update_state(b.tape, b.s);
  const Batch<double> first = columns(e[prefix + "output_first8"]);
  ASSERT_LE(first.rows(), out.rows());
  EXPECT_TRUE(same(out.topRows(first.rows()), first));
  EXPECT_TRUE(same(out.colwise().sum().transpose(),
                   test::vector(e[prefix + "output_sum"])));
  const Batch<double> off = out - target;
  // Without the usual half.
  EXPECT_TRUE(same(off.squaredNorm(), test::number(e[prefix + "loss"])));
  const Vector<double> n =
      norms(b, b.parameters_bar((2 * off).template cast<T>()));
  const Vector<double> stored = test::vector(e["grad_norms"], n.size());
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

template <class T>
void check_packet_surrogate(const Json& e) {
  const Batch<double> y = signals();
  const Index samples = y.rows();
  Bench<T> b(unet({.grid = {samples}, .channels = 1, .scalars_before = 1}),
             1 + samples,
             samples);
  Batch<T> in(1 + samples, y.cols());
  in << columns(e["xi"], 1, y.cols()).template cast<T>(),
      columns(e["eps"], samples, y.cols()).template cast<T>();
  expect_training(b, kPacket, e, "train_", in, y);

  in.bottomRows(samples).setZero();
  const Comparator same = comparator<T>(e);
  const Batch<double> off = b.forward(in).template cast<double>() - y;
  EXPECT_TRUE(same(0.5 * off.colwise().squaredNorm().transpose(),
                   test::vector(e["eval_loss"])));
  const Batch<T> in_bar = b.in_bar(off.template cast<T>());
  EXPECT_TRUE(same(in_bar.topRows(1), columns(e["eval_grad_xi"])));
}

template <class T>
void check_ks_surrogate(const Json& e) {
  const Json problems = test::spoken_of(kKs, "problems");
  const Batch<double> u0 = columns(problems["u0"]);
  Batch<T> in(u0.rows() + 2, u0.cols());
  in << u0.cast<T>(),
      columns(problems["true"], 2, u0.cols()).template cast<T>();
  Bench<T> b(unet({.grid = {u0.rows()},
                   .channels = 1,
                   .scalars_after = 2,
                   .scalar_shift = 1,
                   .scalar_unit = 0.25}),
             in.rows(),
             u0.rows());
  expect_training(
      b, kKs, e, "", in, columns(problems["uT"], u0.rows(), u0.cols()));
}

TEST(ConvReference, Classifiers) {
  test::check_entries_named(kPacket,
                            "jpo_g2s",
                            test::in_both(check_packet_classifier<float>,
                                          check_packet_classifier<double>));
  test::check_entries_named(
      kKs,
      "jpo_g2s",
      test::in_both(check_ks_classifier<float>, check_ks_classifier<double>));
}

TEST(ConvReference, Surrogates) {
  test::check_entries_named(kPacket,
                            "surrogate_unet",
                            test::in_both(check_packet_surrogate<float>,
                                          check_packet_surrogate<double>));
  test::check_entries_named(
      kKs,
      "surrogate_unet",
      test::in_both(check_ks_surrogate<float>, check_ks_surrogate<double>));
}

}  // namespace
}  // namespace physinv::nn
