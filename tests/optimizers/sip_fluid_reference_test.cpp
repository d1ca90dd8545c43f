// The vectors of sip-fluid that are training: its network and three steps of
// Adam. The physics has a test of its own.
#include <cmath>

#include "optimizers/steps/adam.h"
#include "suite/nn/unet.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

constexpr Index kSide = 64, kCells = kSide * kSide;

void expect_outputs(const Json& entry, const std::set<std::string>& known) {
  std::set<std::string> found;
  for (const auto& [key, value] : entry.at("outputs").items())
    found.insert(key);
  EXPECT_EQ(found, known) << entry.at("name");
}

/// The file's in double; in float relative to the largest number.
template <class T>
Comparator tolerance_of(const Json& entry, double largest = 1) {
  const Json& t = entry.at("tolerance");
  if (sizeof(T) == 4) return {1e-3, 1e-3 * largest};
  return {t.at("rel").get<double>(), t.at("abs").get<double>()};
}

/// f(example, channel, i, j) as a batch.
template <class T, class F>
Batch<T> fields(F&& f) {
  return Batch<T>::NullaryExpr(2 * kCells, 2, [=](Index row, Index e) {
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
void check_unet_in(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("outputs");
  const double q = in.at("q");
  const Batch<T> x = fields<T>([q](double e, double c, double i, double j) {
    return std::sin(0.13 * (e + 1) * i + 0.29 * (c + 1) * j + 0.7 * e * c + q) +
           0.3 * std::cos(0.31 * i * (c + 1) - 0.17 * (e + 1) * j + q);
  });
  const Batch<T> bar = fields<T>([q](double e, double k, double i, double j) {
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
  Batch<T> out(2 * kCells, 2);
  Vector<T> p_bar(p.size());
  VectorOut<T> to(p_bar);
  Tape tape;
  Workspace work;
  net->forward(p, state, x, out, tape, work, {.training = true});
  net->backward(p, tape, bar, &to, nullptr, work);

  const auto same = tolerance_of<T>(entry);
  for (Index e = 0; e < 2; ++e)
    for (Index c = 0; c < 2; ++c) {
      const Json& probes = in.at("probes");
      for (std::size_t k = 0; k < probes.size(); ++k) {
        const Index row = c * kCells +
                          probes[k][0].template get<Index>() * kSide +
                          probes[k][1].template get<Index>();
        const Json& one = want.at("probes")[std::size_t(e)][std::size_t(c)][k];
        EXPECT_TRUE(same(double(out(row, e)), one.template get<double>()));
      }
    }
  const Vector<double> norms = vector(want.at("grad_l2_per_tensor"));
  const auto close = tolerance_of<T>(entry, norms.maxCoeff());
  EXPECT_TRUE(same(double(out.norm()), want.at("l2").template get<double>()));
  for (std::size_t l = 0; l < tensors.size(); ++l) {
    Index size = 1;
    for (const Json& n : want.at("tensor_shapes")[l])
      size *= n.template get<Index>();
    ASSERT_EQ(tensors[l].size, size) << l;
    const Vector<double> g =
        p_bar.segment(tensors[l].offset, size).template cast<double>();
    EXPECT_TRUE(close(g.norm(), norms(Index(l)))) << tensors[l].name;
    const Vector<double> first = vector(want.at("grad_first3_per_tensor")[l]);
    EXPECT_TRUE(close(Vector<double>(g.head(first.size())), first))
        << tensors[l].name;
  }
}

void check_unet(const Json& entry) {
  expect_outputs(entry,
                 {"parameter_count",
                  "probes",
                  "l2",
                  "grad_l2_per_tensor",
                  "grad_first3_per_tensor",
                  "tensor_shapes"});
  check_unet_in<double>(entry);
  check_unet_in<float>(entry);
}

template <class T>
void check_adam_in(const Json& entry) {
  const Json& in = entry.at("inputs");
  Adam<T> adam({.rate = in.at("lr"),
                .beta1 = in.at("beta1"),
                .beta2 = in.at("beta2"),
                .eps = in.at("eps")});
  Vector<T> x = vector(in.at("start")).cast<T>();
  const Comparator same =
      sizeof(T) == 4 ? Comparator(1e-6, 1e-8) : tolerance_of<double>(entry);
  for (std::size_t k = 0; k < in.at("gradients").size(); ++k) {
    adam.step(x, vector(in.at("gradients")[k]).cast<T>());
    EXPECT_TRUE(same(Vector<double>(x.template cast<double>()),
                     vector(entry.at("outputs").at("after_each_step")[k])));
  }
}

void check_adam(const Json& entry) {
  expect_outputs(entry, {"after_each_step"});
  check_adam_in<double>(entry);
  check_adam_in<float>(entry);
}

TEST(SipFluidReference, NetworkAndAdam) {
  check_entries("sip-fluid",
                {{"u_net", check_unet}, {"adam", check_adam}},
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
