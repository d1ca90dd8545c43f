// The vectors of sip-wave-packet: signals, losses and gradients of the problem,
// searches by L-BFGS-B, and the network, trained through the stage itself.
#include <numbers>

#include "optimizers/drive.h"
#include "optimizers/lbfgsb.h"
#include "optimizers/training.h"
#include "problems/wave_packet/wave_packet.h"
#include "suite/nn/pooled_cnn.h"
#include "tests/support/hig_reference.h"
#include "tests/support/quadratic.h"

namespace physinv::test {
namespace {

const std::string kId = "sip-wave-packet";
constexpr Index kSamples = 256;
constexpr double kCentre = 76.8, kHalfRange = 51.2;

WavePacketOptions sine() {
  return {.frequency = 0.7,
          .phase = -std::numbers::pi / 2,
          .width = 20,
          .centre = kCentre,
          .scale = 1,
          .range = {25.6, 128},
          .half_loss = false};
}

/// The signals that all other entries are about.
Batch<double> signals() {
  const auto found = reference_entries(kId, "loss-and-gradient");
  if (found.size() != 1) throw std::runtime_error("which signals?");
  return columns(found.front().at("inputs").at("y"));
}

/// Single precision has its own rounding to lose.
template <class T>
Comparator tolerance(const Json& entry, double rtol, double atol) {
  const Json& t = entry.at("tolerance");
  if (sizeof(T) == 4) return {rtol, atol};
  return {t.at("rtol").get<double>(), t.at("atol").get<double>()};
}

/// Signals, losses and slopes at t0 (columns), against the same columns of y.
template <class T>
struct Packet {
  Packet(const Vector<double>& t0, const Batch<double>& target)
      : y(kSamples, t0.size()), slope(1, t0.size()), loss(t0.size()) {
    const WavePacket<T> packet(sine());
    const Batch<T> xi = (t0.array() - kCentre).matrix().transpose().cast<T>();
    const Batch<T> seen = target.cast<T>();
    Batch<T> y_bar(y), given = Batch<T>::Zero(kSamples, t0.size());
    Tape tape;
    Workspace work;
    packet.linearize(xi, given, y, tape);
    packet.loss(y, seen, loss);
    packet.loss_gradient(y, seen, y_bar);
    packet.pullback(tape, y_bar, slope, work);
  }
  Batch<T> y, slope;
  Vector<double> loss;
};

template <class T>
void check_signal_in(const Json& entry) {
  Expected want(entry);
  const Batch<double> y = columns(want.at("y"));
  const Vector<double> t0 = vector(entry.at("inputs").at("t0"));
  EXPECT_TRUE(tolerance<T>(entry, 0, 2e-6)(Packet<T>(t0, y).y, y));
}

template <class T>
void check_loss_in(const Json& entry) {
  Expected want(entry);
  const Json& in = entry.at("inputs");
  const Vector<double> query = vector(in.at("query"));
  const Batch<double> y = signals(), loss = columns(want.at("loss")),
                      slope = columns(want.at("gradient"));
  ASSERT_EQ(y.cols(), vector(in.at("t0_true")).size());
  for (Index i = 0; i < y.cols(); ++i) {
    const Packet<T> at(query, y.col(i).replicate(1, query.size()));
    EXPECT_TRUE(tolerance<T>(entry, 2e-5, 0)(at.loss, loss.col(i)));
    EXPECT_TRUE(tolerance<T>(entry, 2e-4, 2e-4)(
        Batch<double>(at.slope.transpose().template cast<double>()),
        slope.col(i)));
  }
}

/// Where the search ends from t0, one for each signal.
Vector<double> found_from(const Vector<double>& t0) {
  const Batch<double> y = signals();
  const auto objective = [&](std::span<const Index> active,
                             BatchIn<double> x,
                             VectorOut<double> loss,
                             BatchOut<double> gradient) {
    Batch<double> target(kSamples, x.cols());
    for (Index k = 0; k < x.cols(); ++k)
      target.col(k) = y.col(active[static_cast<std::size_t>(k)]);
    const Packet<double> at(x.row(0).transpose(), target);
    loss = at.loss;
    gradient = at.slope;
  };
  Lbfgsb solver;
  drive(solver, objective, t0.transpose());
  for (const Status s : solver.status()) EXPECT_EQ(s, Status::gtol);
  return solver.x().row(0).transpose();
}

/// The search stays there, and no place of a dense scan is better.
void check_minimum(const Json& entry) {
  Expected want(entry);
  const Batch<double> best = columns(want.at("t0_and_loss")), y = signals();
  const Vector<double> t0 = best.row(0).transpose();
  const auto same = tolerance<double>(entry, 0, 0);
  EXPECT_TRUE(same(Packet<double>(t0, y).loss,
                   Vector<double>(best.row(1).transpose())));
  EXPECT_TRUE(Comparator(0, 1e-6)(found_from(t0), t0));
  const auto scan = Vector<double>::LinSpaced(5701, 20, 134);
  for (Index i = 0; i < y.cols(); ++i)
    EXPECT_GE(Packet<double>(scan, y.col(i).replicate(1, scan.size()))
                  .loss.minCoeff(),
              best(1, i) - 1e-9);
}

void check_search(const Json& entry) {
  Expected want(entry);
  const Batch<double> starts = rows(entry.at("inputs").at("starts")),
                      t0 = rows(want.at("t0"));
  for (Index k = 0; k < starts.cols(); ++k)
    EXPECT_TRUE(tolerance<double>(entry, 0, 0)(found_from(starts.col(k)),
                                               Vector<double>(t0.col(k))));
}

NetworkRecipe network(bool batch_norm) {
  return nn::pooled_cnn({.positions = kSamples,
                         .features = {16, 16, 16, 16, 16},
                         .hidden = {64, 32},
                         .output = nn::Activation::half_tanh,
                         .batch_norm = batch_norm});
}

/// u(k) s / sqrt(fan_in) by the number of the parameter; of a normalisation
/// 1 + u / 10 and u / 10.
template <class T>
Vector<T> weights(const Json& rule, const Network<T>& net) {
  const auto at = [&](const char* key) { return rule.at(key).get<Index>(); };
  Vector<T> all(net.parameter_count());
  for (const TensorInfo& tensor : net.tensors()) {
    const double scale = rule.at("s").get<double>() /
                         std::sqrt(static_cast<double>(tensor.fan_in));
    for (Index k = tensor.offset; k < tensor.offset + tensor.size; ++k) {
      const Index n = (at("a") * k * k + at("b") * k + at("c")) % at("m");
      const double u = 2.0 * double(n) / double(at("m") - 1) - 1;
      all(k) = static_cast<T>(tensor.kind == 's'   ? 1 + 0.1 * u
                              : tensor.kind == 'o' ? 0.1 * u
                                                   : u * scale);
    }
  }
  return all;
}

template <class T>
void check_network_in(const Json& entry) {
  const bool batch_norm = entry.at("name") == "network-bn";
  Expected want(entry);
  const auto net = network(batch_norm).make<T>(kSamples, 1);
  EXPECT_EQ(net->parameter_count(), want.at("parameter_count").get<Index>());
  const Vector<T> p = weights(entry.at("inputs").at("weights"), *net);
  Vector<T> state(net->state_count()), gradient(p.size());
  const Batch<double> y = signals().leftCols(4);
  const Batch<T> in = y.cast<T>();
  Batch<T> out(1, 4);
  Tape tape;
  Workspace work;
  net->forward(p, state, in, out, tape, work, {.training = true});
  const Vector<double> t0 =
      kCentre +
      kHalfRange * out.row(0).transpose().template cast<double>().array();
  const auto same = tolerance<T>(entry, 1e-4, 0);
  EXPECT_TRUE(same(t0, vector(want.at("t0"))));
  const Packet<T> packet(t0, y);
  EXPECT_TRUE(tolerance<T>(entry, 1e-3, 0)(packet.loss.sum(),
                                           want.at("loss").get<double>()));

  const Batch<T> out_bar = T(kHalfRange) * packet.slope;
  VectorOut<T> bar(gradient);
  net->backward(p, tape, out_bar, &bar, nullptr, work);
  const Vector<double> norms = vector(want.at("gradient_norms"));
  const auto& tensors = net->tensors();
  ASSERT_EQ(static_cast<Index>(tensors.size()), norms.size());
  const auto part = [&](const TensorInfo& t) {
    return gradient.segment(t.offset, t.size).template cast<double>().eval();
  };
  const auto near = tolerance<T>(entry, 2e-3, 0.05);
  for (std::size_t t = 0; t < tensors.size(); ++t) {
    SCOPED_TRACE(tensors[t].name);
    // Biases in front of a normalisation do nothing.
    if (batch_norm && tensors[t].kind == 'b' && t + 6 < tensors.size())
      EXPECT_EQ(part(tensors[t]).norm(), 0);
    else
      EXPECT_TRUE(near(part(tensors[t]).norm(), norms(Index(t))));
  }
  EXPECT_TRUE(near(part(tensors[tensors.size() - 2]),
                   vector(want.at("last_layer_gradient"))));
}

/// The signals of the file, whatever set is asked for.
template <class T>
class Listed final : public WavePacket<T> {
 public:
  using Options = WavePacketOptions;
  explicit Listed(const Options& options = {}) : WavePacket<T>(options) {}

  Samples<double> sample(Index first, Index count, const Rng&) const override {
    return {Batch<double>::Zero(1, count),
            signals().middleCols(first, count),
            Batch<double>::Zero(kSamples, count)};
  }
};

void check_steps(const Json& entry) {
  Expected want(entry);
  const Batch<double> t0 = columns(want.at("t0"));
  const auto net = network(false);
  const auto stage = train({.rule = AdamOptions{.rate = 1e-3, .eps = 1e-8},
                            .batch = 4,
                            .gradient_scale = 4});
  for (const Precision p : {Precision::f64, Precision::f32}) {
    const auto same = p == Precision::f64 ? tolerance<double>(entry, 0, 0)
                                          : Comparator(1e-3, 0);
    for (Index k = 0; k < t0.cols(); ++k) {
      StageBench bench(*stage,
                       4,
                       k + 1,
                       problem<Listed>("wave_packet", sine()),
                       {.predictor = {{Field::observations}, net},
                        .output_scale = kHalfRange});
      const auto start = reference_entries(kId, "network").front();
      Outcome before;
      before.arrays["parameters"] = weights(start.at("inputs").at("weights"),
                                            *net.make<double>(kSamples, 1));
      before.arrays["state"] = Batch<double>(0, 1);
      const Outcome out = bench.run(&before, p);
      EXPECT_TRUE(same((out.x.row(0).transpose().array() + kCentre).matrix(),
                       t0.col(k)))
          << "update " << k + 1;
    }
  }
}

TEST(SipWavePacketReference, AllEntries) {
  const auto both = [](auto in_double, auto in_float) {
    return [=](const Json& entry) { in_double(entry), in_float(entry); };
  };
  check_entries(
      kId,
      {{"signal", both(check_signal_in<double>, check_signal_in<float>)},
       {"loss-and-gradient", both(check_loss_in<double>, check_loss_in<float>)},
       {"global-minimum", check_minimum},
       {"local-search", check_search},
       {"network", both(check_network_in<double>, check_network_in<float>)},
       {"three-adam-steps", check_steps},
       {"network-bn",
        both(check_network_in<double>, check_network_in<float>)}});
}

}  // namespace
}  // namespace physinv::test
