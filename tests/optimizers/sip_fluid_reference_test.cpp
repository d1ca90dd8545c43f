// The vectors of sip-fluid that are training: its network and three steps of
// Adam. The physics has a test of its own.
#include <array>
#include <cmath>

#include "optimizers/steps/adam.h"
#include "suite/nn/unet.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

/// Cells per side of the specification; no entry states another.
constexpr Index kSide = 64, kCells = kSide * kSide;

/// The file's in double; in float relative to the largest number.
template <class T>
Comparator tolerance_of(const Json& entry, double largest = 1) {
  const Json& t = entry.at("tolerance");
  if (sizeof(T) == 4) return {1e-3, 1e-3 * largest};
  return {number(t.at("rel")), number(t.at("abs"))};
}

/// f(example, channel, i, j) as a batch of two channels.
template <class T, class F>
Batch<T> waves(Index examples, F&& f) {
  return Batch<T>::NullaryExpr(2 * kCells, examples, [=](Index row, Index e) {
    return static_cast<T>(f(double(e),
                            double(row / kCells),
                            double(row % kCells / kSide),
                            double(row % kSide)));
  });
}

Vector<double> weights(const std::vector<TensorInfo>& tensors) {
  const TensorInfo& last = tensors.back();
  Vector<double> w(last.offset + last.size);
  for (std::size_t l = 0; l < tensors.size(); ++l) {
    const TensorInfo& t = tensors[l];
    const bool vector = t.kind != 'k' && t.kind != 'm';
    const double scale = vector ? 0.1 : std::sqrt(2.0 / double(t.fan_in));
    for (Index k = 0; k < t.size; ++k)
      w(t.offset + k) = scale * std::sin(0.37 * double(k) + 1.1 * double(l)) +
                        (t.kind == 's' ? 1 : 0);
  }
  return w;
}

template <class T>
void check_unet(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("outputs");
  expect_formula(in,
                 "input",
                 "x[e][c][i][j]=sin(0.13(e+1)i+0.29(c+1)j+0.7ec+q)+"
                 "0.3cos(0.31 i (c+1)-0.17(e+1)j+q)");
  expect_formula(in, "cotangent", "sin(0.05 i (k+1)+0.07 j+e+q)");
  const double q = in.at("q");
  const Index n = in.at("n");
  ASSERT_GE(n, 1);
  const Batch<T> x = waves<T>(n, [q](double e, double c, double i, double j) {
    return std::sin(0.13 * (e + 1) * i + 0.29 * (c + 1) * j + 0.7 * e * c + q) +
           0.3 * std::cos(0.31 * i * (c + 1) - 0.17 * (e + 1) * j + q);
  });
  const Batch<T> bar = waves<T>(n, [q](double e, double k, double i, double j) {
    return std::sin(0.05 * i * (k + 1) + 0.07 * j + e + q);
  });
  const auto net = nn::unet({.grid = {kSide, kSide},
                             .channels = 2,
                             .levels = 5,
                             .outputs = 2,
                             .padding = nn::Padding::circular,
                             .batch_statistics = true})
                       .make<T>(2 * kCells, 2 * kCells);
  const auto& tensors = net->tensors();
  ASSERT_EQ(net->parameter_count(), want.at("parameter_count").get<Index>());
  ASSERT_EQ(tensors.size(), want.at("tensor_shapes").size());
  const Vector<T> p = weights(tensors).template cast<T>();
  const Vector<T> state = Vector<T>::Zero(net->state_count());
  Batch<T> out(2 * kCells, n);
  Vector<T> p_bar(p.size());
  VectorOut<T> to(p_bar);
  Tape tape;
  Workspace work;
  net->forward(p, state, x, out, tape, work, {.training = true});
  net->backward(p, tape, bar, &to, nullptr, work);

  const auto same = tolerance_of<T>(entry);
  const std::vector<std::array<Index, 2>> probes = in.at("probes");
  ASSERT_EQ(static_cast<Index>(want.at("probes").size()), n);
  for (Index e = 0; e < n; ++e)
    for (Index c = 0; c < 2; ++c) {
      const Vector<double> stored = vector(want.at("probes")[e][c]);
      ASSERT_EQ(static_cast<std::size_t>(stored.size()), probes.size());
      for (std::size_t k = 0; k < probes.size(); ++k) {
        const auto [i, j] = probes[k];
        ASSERT_TRUE(0 <= i && i < kSide && 0 <= j && j < kSide);
        EXPECT_TRUE(
            same(double(out(c * kCells + i * kSide + j, e)), stored(Index(k))));
      }
    }
  const Vector<double> norms = vector(want.at("grad_l2_per_tensor"));
  const auto close = tolerance_of<T>(entry, norms.maxCoeff());
  EXPECT_TRUE(same(double(out.norm()), number(want.at("l2"))));
  ASSERT_EQ(norms.size(), Index(tensors.size()));
  for (std::size_t l = 0; l < tensors.size(); ++l) {
    Index size = 1;
    for (const Json& extent : want.at("tensor_shapes")[l])
      size *= extent.template get<Index>();
    ASSERT_EQ(tensors[l].size, size) << l;
    const Vector<double> g =
        p_bar.segment(tensors[l].offset, size).template cast<double>();
    EXPECT_TRUE(close(g.norm(), norms(Index(l)))) << tensors[l].name;
    const Vector<double> first = vector(want.at("grad_first3_per_tensor")[l]);
    ASSERT_LE(first.size(), size);
    EXPECT_TRUE(close(Vector<double>(g.head(first.size())), first))
        << tensors[l].name;
  }
}

template <class T>
void check_adam(const Json& entry) {
  const Json in = entry.at("inputs");
  const Json after = entry.at("outputs").at("after_each_step");
  ASSERT_EQ(after.size(), in.at("gradients").size());
  Adam<T> adam({.rate = in.at("lr"),
                .beta1 = in.at("beta1"),
                .beta2 = in.at("beta2"),
                .eps = in.at("eps")});
  Vector<T> x = vector(in.at("start")).template cast<T>();
  const Comparator same =
      sizeof(T) == 4 ? Comparator(1e-6, 1e-8) : tolerance_of<double>(entry);
  for (std::size_t k = 0; k < in.at("gradients").size(); ++k) {
    adam.step(x, vector(in.at("gradients")[k], x.size()).template cast<T>());
    EXPECT_TRUE(
        same(Vector<double>(x.template cast<double>()), vector(after[k])));
  }
}

TEST(SipFluidReference, NetworkAndAdam) {
  check_entries("sip-fluid",
                {{"u_net", in_both(check_unet<float>, check_unet<double>)},
                 {"adam", in_both(check_adam<float>, check_adam<double>)}},
                {"mac_cormack_periodic",
                 "stagger_project",
                 "step",
                 "frequency_loss",
                 "vortex_moment",
                 "scene",
                 "discretise"});
}

}  // namespace
}  // namespace physinv::test
