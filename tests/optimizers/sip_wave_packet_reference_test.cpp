// The vectors of sip-wave-packet: signals, losses and gradients of the problem,
// searches by L-BFGS-B, and the network, trained through the stage itself.
#include <algorithm>
#include <numbers>
#include <regex>
#include <stdexcept>
#include <string>

#include "optimizers/drive.h"
#include "optimizers/lbfgsb.h"
#include "optimizers/training.h"
#include "problems/wave_packet/wave_packet.h"
#include "suite/nn/pooled_cnn.h"
#include "tests/support/listed.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kPacket = "sip-wave-packet";
constexpr double kCentre = 76.8, kHalfRange = 51.2;

/// The problem of the specification, on as many samples as the signals have.
WavePacketOptions sine(Index samples) {
  return {.samples = samples,
          .frequency = 0.7,
          .phase = -std::numbers::pi / 2,
          .width = 20,
          .centre = kCentre,
          .scale = 1,
          .range = {25.6, 128},
          .half_loss = false};
}

/// The signals that `words` speak about: lists of numbers, "the signals of
/// loss-and-gradient", "first four of loss-and-gradient".
Batch<double> signals_of(const Json& words) {
  if (words.is_array()) return columns(words);
  static const std::regex form("(?:the signals|first (\\w+)) of (\\S+)");
  static const std::vector<std::string> kNumbers = {"zero",
                                                    "one",
                                                    "two",
                                                    "three",
                                                    "four",
                                                    "five",
                                                    "six",
                                                    "seven",
                                                    "eight",
                                                    "nine",
                                                    "ten"};
  const std::string said = words;
  std::smatch found;
  if (!std::regex_match(said, found, form))
    throw std::runtime_error(words.path() + " is \"" + said +
                             "\", expected \"first four of NAME\"");
  const Batch<double> all =
      columns(spoken_of(kPacket, found[2]).at("inputs").at("y"));
  if (!found[1].matched) return all;
  const std::string number = found[1];
  const auto at = std::find(kNumbers.begin(), kNumbers.end(), number);
  const Index count =
      at == kNumbers.end() ? std::stol(number) : at - kNumbers.begin();
  if (count < 1 || count > all.cols())
    throw std::runtime_error(words.path() + " is \"" + said + "\" of " +
                             std::to_string(all.cols()));
  return all.leftCols(count);
}
/// Of an entry that does not say which.
Batch<double> signals() {
  return columns(spoken_of(kPacket, "loss-and-gradient").at("inputs").at("y"));
}

/// Single precision has its own rounding to lose.
template <class T>
Comparator tolerance(const Json& entry, double rtol, double atol) {
  if (sizeof(T) == 4) return {rtol, atol};
  return EntryTolerance(entry.at("tolerance")).array();
}

/// Signals, losses and slopes at t0 (columns), against the same columns of y.
template <class T>
struct Packet {
  Packet(const Vector<double>& t0, const Batch<double>& target)
      : y(target.rows(), t0.size()), slope(1, t0.size()), loss(t0.size()) {
    const AnyProblem<T> packet(problems::wave_packet(sine(target.rows())));
    const Batch<T> xi = (t0.array() - kCentre).matrix().transpose().cast<T>();
    const Batch<T> seen = target.cast<T>();
    Batch<T> y_bar(y), given = Batch<T>::Zero(y.rows(), y.cols());
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
void check_signal(const Json& entry) {
  const Json want = entry.at("expected");
  const Batch<double> y = columns(want.at("y"));
  const Vector<double> t0 = vector(entry.at("inputs").at("t0"), y.cols());
  EXPECT_TRUE(tolerance<T>(entry, 0, 2e-6)(Packet<T>(t0, y).y, y));
}

template <class T>
void check_loss(const Json& entry) {
  const Json want = entry.at("expected");
  const Json in = entry.at("inputs");
  const Vector<double> query = vector(in.at("query"));
  const Batch<double> y = signals_of(in.at("y")),
                      loss = columns(want.at("loss"), query.size(), y.cols()),
                      slope =
                          columns(want.at("gradient"), query.size(), y.cols());
  vector(in.at("t0_true"), y.cols());
  for (Index i = 0; i < y.cols(); ++i) {
    const Packet<T> at(query, y.col(i).replicate(1, query.size()));
    EXPECT_TRUE(tolerance<T>(entry, 2e-5, 0)(at.loss, loss.col(i)));
    EXPECT_TRUE(tolerance<T>(entry, 2e-4, 2e-4)(
        Batch<double>(at.slope.transpose().template cast<double>()),
        slope.col(i)));
  }
}

/// Where the search ends from t0, one for each signal.
Vector<double> found_from(const Vector<double>& t0, const Batch<double>& y) {
  const auto objective = [&](std::span<const Index> active,
                             BatchIn<double> x,
                             VectorOut<double> loss,
                             BatchOut<double> gradient) {
    Batch<double> target(y.rows(), x.cols());
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
  const Json want = entry.at("expected");
  const Batch<double> y = signals_of(entry.at("inputs").at("y")),
                      best = columns(want.at("t0_and_loss"), 2, y.cols());
  const Vector<double> t0 = best.row(0).transpose();
  const auto same = tolerance<double>(entry, 0, 0);
  EXPECT_TRUE(same(Packet<double>(t0, y).loss,
                   Vector<double>(best.row(1).transpose())));
  EXPECT_TRUE(Comparator(0, 1e-6)(found_from(t0, y), t0));
  const auto scan = Vector<double>::LinSpaced(5701, 20, 134);
  for (Index i = 0; i < y.cols(); ++i)
    EXPECT_GE(Packet<double>(scan, y.col(i).replicate(1, scan.size()))
                  .loss.minCoeff(),
              best(1, i) - 1e-9);
}

void check_search(const Json& entry) {
  const Json want = entry.at("expected");
  const Batch<double> y = signals(),
                      starts = rows(entry.at("inputs").at("starts"), y.cols()),
                      t0 = rows(want.at("t0"), y.cols(), starts.cols());
  for (Index k = 0; k < starts.cols(); ++k)
    EXPECT_TRUE(tolerance<double>(entry, 0, 0)(found_from(starts.col(k), y),
                                               Vector<double>(t0.col(k))));
}

NetworkRecipe network(Index samples, bool batch_norm) {
  return nn::pooled_cnn({.positions = samples,
                         .features = {16, 16, 16, 16, 16},
                         .hidden = {64, 32},
                         .output = nn::Activation::half_tanh,
                         .batch_norm = batch_norm});
}

template <class T>
void check_network(const Json& entry) {
  const bool batch_norm = entry.at("name") == "network-bn";
  const Json want = entry.at("expected");
  const Json inputs = entry.at("inputs");
  const Batch<double> y = signals_of(inputs.at("signals"));
  const auto net = network(y.rows(), batch_norm).make<T>(y.rows(), 1);
  EXPECT_EQ(net->parameter_count(),
            want.at("parameter_count").template get<Index>());
  const Vector<T> p = recurrence_weights(inputs.at("weights"), net->tensors())
                          .template cast<T>();
  Vector<T> state(net->state_count()), gradient(p.size());
  const Batch<T> in = y.cast<T>();
  Batch<T> out(1, y.cols());
  Tape tape;
  Workspace work;
  net->forward(p, state, in, out, tape, work, {.training = true});
  const Vector<double> t0 =
      kCentre +
      kHalfRange * out.row(0).transpose().template cast<double>().array();
  const auto same = tolerance<T>(entry, 1e-4, 0);
  EXPECT_TRUE(same(t0, vector(want.at("t0"))));
  const Packet<T> packet(t0, y);
  EXPECT_TRUE(
      tolerance<T>(entry, 1e-3, 0)(packet.loss.sum(), number(want.at("loss"))));

  const Batch<T> out_bar = T(kHalfRange) * packet.slope;
  VectorOut<T> bar(gradient);
  net->backward(p, tape, out_bar, &bar, nullptr, work);
  const auto& tensors = net->tensors();
  const Vector<double> norms =
      vector(want.at("gradient_norms"), static_cast<Index>(tensors.size()));
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

/// These signals.
ProblemRecipe listed_packets(const Batch<double>& y) {
  return with_samples(problems::wave_packet(sine(y.rows())),
                      {Batch<double>::Zero(1, y.cols()),
                       y,
                       Batch<double>::Zero(y.rows(), y.cols())});
}

/// The network, weights and signals of another entry.
Json start_of(const Json& entry) {
  static const std::string kWords = "weights of entry ";
  const std::string said = entry.at("inputs").at("start");
  if (!said.starts_with(kWords))
    throw std::runtime_error("inputs.start is \"" + said + "\", expected \"" +
                             kWords + "NAME\"");
  return spoken_of(kPacket, said.substr(kWords.size()));
}

void check_packet_steps(const Json& entry) {
  const Json want = entry.at("expected"), start = start_of(entry);
  const Batch<double> t0 = columns(want.at("t0")),
                      y = signals_of(start.at("inputs").at("signals"));
  ASSERT_EQ(t0.rows(), y.cols());
  const auto net =
      network(y.rows(), start.at("name").get<std::string>().ends_with("-bn"));
  const auto plain = net.make<double>(y.rows(), 1);
  const double rate = setting(entry, "lr", "lr ", 1e-3);
  const auto stage = train({.rule = AdamOptions{.rate = rate, .eps = 1e-8},
                            .batch = y.cols(),
                            .gradient_scale = double(y.cols())});
  for (const Precision p : {Precision::f64, Precision::f32}) {
    const auto same = p == Precision::f64 ? tolerance<double>(entry, 0, 0)
                                          : Comparator(1e-3, 0);
    for (Index k = 0; k < t0.cols(); ++k) {
      StageBench bench(*stage,
                       y.cols(),
                       k + 1,
                       listed_packets(y),
                       {.predictor = {{Field::observations}, net},
                        .output_scale = kHalfRange});
      Outcome before;
      before.arrays["parameters"] = recurrence_weights(
          start.at("inputs").at("weights"), plain->tensors());
      before.arrays["state"] = Batch<double>::Zero(plain->state_count(), 1);
      const Outcome out = bench.run(&before, p);
      EXPECT_TRUE(same((out.x.row(0).transpose().array() + kCentre).matrix(),
                       t0.col(k)))
          << "update " << k + 1;
    }
  }
}

TEST(SipWavePacketReference, AllEntries) {
  check_entries(
      kPacket,
      {{"signal", in_both(check_signal<float>, check_signal<double>)},
       {"loss-and-gradient", in_both(check_loss<float>, check_loss<double>)},
       {"global-minimum", check_minimum},
       {"local-search", check_search},
       {"network", in_both(check_network<float>, check_network<double>)},
       {"three-adam-steps", check_packet_steps},
       {"network-bn", in_both(check_network<float>, check_network<double>)}});
}

}  // namespace
}  // namespace physinv::test
