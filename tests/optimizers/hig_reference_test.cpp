// The reference files' updates of network and solver together: loss, gradient
// and powers of the stacked Jacobian at given weights, and short trainings.
#include "tests/support/hig_reference.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <regex>

#include "optimizers/half_inverse_step.h"
#include "optimizers/steps/rule.h"
#include "problems/grid_poisson/grid_poisson.h"
#include "problems/oscillators/oscillators.h"
#include "problems/quantum_dipole/quantum_dipole.h"
#include "problems/scaled_output/scaled_output.h"
#include "suite/nn/mlp.h"

namespace physinv::test {
namespace {

/// A dense network whose flat vectors are the files': matrices [in][out].
class Dense {
 public:
  Dense(const std::vector<Index>& sizes, nn::Activation activation)
      : sizes_(sizes) {
    net = nn::mlp({.hidden = {sizes.begin() + 1, sizes.end() - 1},
                   .activation = activation})
              .make<double>(sizes.front(), sizes.back());
  }

  Vector<double> ours(const Vector<double>& theirs) const {
    return permuted(theirs, false);
  }
  Vector<double> theirs(const Vector<double>& ours) const {
    return permuted(ours, true);
  }

  std::unique_ptr<Network<double>> net;

 private:
  Vector<double> permuted(const Vector<double>& from, bool back) const {
    Vector<double> to = from;
    Index at = 0;
    for (std::size_t l = 0; l + 1 < sizes_.size(); ++l) {
      const Index in = sizes_[l], out = sizes_[l + 1];
      for (Index i = 0; i < in; ++i) {
        for (Index o = 0; o < out; ++o) {
          const Index mine = at + o * in + i, other = at + i * out + o;
          to(back ? other : mine) = from(back ? mine : other);
        }
      }
      at += in * out + out;
    }
    return to;
  }

  std::vector<Index> sizes_;
};

/// One experiment of the files.
struct Learner {
  std::unique_ptr<Problem<double>> problem;
  Dense network;
  /// g = factor(b) dl/dy
  std::function<double(Index)> factor;
  bool given_is_target = false, input_is_given = false;
};

/// Everything at one set of weights for one batch of observations.
struct At {
  At(const Learner& l,
     const Vector<double>& theirs,
     const Batch<double>& target,
     const Batch<double>& given)
      : learner(l), theta(l.network.ours(theirs)) {
    const Shape shape = l.problem->shape();
    const Index n = target.cols();
    const Network<double>& net = *l.network.net;
    x.resize(shape.unknowns, n), y.resize(shape.observations, n);
    g.resizeLike(y), loss.resize(n);
    jacobian.resize(y.rows() * x.rows(), n);
    net.forward(theta,
                Vector<double>(),
                l.input_is_given ? given : target,
                x,
                tape,
                work,
                {.training = true});
    l.problem->forward(x, given, y, work);
    l.problem->loss(y, target, loss);
    l.problem->loss_gradient(y, target, g);
    dynamic_cast<const Jacobian<double>&>(*l.problem)
        .jacobian(x, given, jacobian, work);
    mean_gradient = g / static_cast<double>(n);
    g *= l.factor(n);
    if (auto* p =
            dynamic_cast<const GradientProjection<double>*>(l.problem.get()))
      p->project(y, g);
  }

  Vector<double> gradient() {
    const auto& net = *learner.network.net;
    Batch<double> x_bar(x.rows(), x.cols());
    for (Index i = 0; i < x.cols(); ++i)
      x_bar.col(i) = Eigen::Map<const Batch<double>>(
                         jacobian.col(i).data(), y.rows(), x.rows())
                         .transpose() *
                     mean_gradient.col(i);
    Vector<double> bar(theta.size());
    VectorOut<double> out(bar);
    net.backward(theta, tape, x_bar, &out, nullptr, work);
    return learner.network.theirs(bar);
  }

  /// Takes the update off theta.
  Vector<double> update(HalfInverseStep<double>& step) {
    EXPECT_TRUE(step(*learner.network.net, theta, tape, jacobian, g, work));
    return learner.network.theirs(step.update());
  }

  const Learner& learner;
  Vector<double> theta, loss;
  Batch<double> x, y, g, mean_gradient, jacobian;
  Tape tape;
  Workspace work;
};

Learner oscillators() {
  return {.problem = std::make_unique<Oscillators<double>>(),
          .network = {{4, 20, 20, 20, 96}, nn::Activation::relu},
          .factor = [](Index b) { return 1.0 / static_cast<double>(b); },
          .given_is_target = true};
}

Learner poisson() {
  return {.problem = std::make_unique<GridPoisson<double>>(),
          .network = {{64, 64, 256, 64, 64}, nn::Activation::tanh},
          .factor = [](Index) { return 1.0; }};
}

Learner quantum() {
  return {.problem = std::make_unique<QuantumDipole<double>>(),
          .network = {{28, 20, 20, 20, 384}, nn::Activation::tanh},
          .factor = [](Index b) { return 1.0 / static_cast<double>(b); }};
}

/// One column per sample.
Batch<double> columns(const Json& list) {
  const Vector<double> all = flat(list);
  const auto n = static_cast<Index>(list.size());
  return Eigen::Map<const Batch<double>>(all.data(), all.size() / n, n);
}

Batch<double> given_for(const Learner& l, const Batch<double>& target) {
  return l.given_is_target ? target : Batch<double>(0, target.cols());
}

Vector<double> start_weights(const Json& in, const std::vector<Index>& sizes) {
  return hig_weights(
      hig_dense(
          sizes, in.value("weight_gain", 1.0), in.value("bias_scale", 0.1)),
      in.at("weights_offset").get<std::uint32_t>());
}

/// delta_k-0.5_tau1e-05_beta0, the last part optional.
bool parse(const std::string& key, hig::Power& power) {
  static const std::regex form(
      "delta_k([-0-9.]+)_tau([-0-9.e]+)(?:_beta([-0-9.]+))?");
  std::smatch part;
  if (!std::regex_match(key, part, form)) return false;
  power = {.kappa = std::stod(part[1]),
           .tau = std::stod(part[2]),
           .beta = part[3].matched ? std::stod(part[3]) : 0};
  return true;
}

void check_batch(const Learner& l,
                 const std::vector<Index>& sizes,
                 const char* targets,
                 const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const HigTolerance tolerance(entry);
  const auto same = tolerance.array();
  const Batch<double> target = columns(in.at(targets));
  At at(l, start_weights(in, sizes), target, given_for(l, target));
  if (out.contains("loss")) EXPECT_TRUE(same(at.loss.mean(), out.at("loss")));
  if (out.contains("loss_sum"))
    EXPECT_TRUE(same(at.loss.sum(), out.at("loss_sum")));
  if (out.contains("y")) EXPECT_TRUE(same(at.y, columns(out.at("y"))));
  if (out.contains("psi")) EXPECT_TRUE(same(at.y, columns(out.at("psi"))));
  const char* gradient = out.contains("grad_loss") ? "grad_loss" : "grad_mean";
  EXPECT_TRUE(same.summary(at.gradient(), out.at(gradient)));
  int updates = 0;
  for (const auto& [key, stored] : out.items()) {
    hig::Power power;
    if (!parse(key, power)) continue;
    SCOPED_TRACE(key);
    for (const bool strict : {false, true}) {
      HalfInverseStepOptions options{.power = power};
      if (strict) options.numerics.tolerance = 1e-8;
      HalfInverseStep<double> step(options);
      const Vector<double> before = at.theta;
      EXPECT_TRUE(tolerance.delta(strict).summary(at.update(step), stored));
      at.theta = before;
    }
    ++updates;
  }
  EXPECT_GE(updates, 2);
}

/// Consecutive minibatches in fixed order.
void check_sequence(const Learner& l,
                    const std::vector<Index>& sizes,
                    const char* targets,
                    Index batch,
                    const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const Batch<double> all = columns(in.at(targets));
  HalfInverseStep<double> step(
      {.power = {.kappa = in.value("kappa", -0.5), .tau = in.at("tau")},
       .rate = in.at("eta"),
       .numerics = {.tolerance = 1e-8}});
  Vector<double> theta = start_weights(in, sizes);
  const bool before = out.contains("losses_before");
  const Vector<double> losses =
      flat(out.at(before ? "losses_before" : "losses"));
  const Index updates = losses.size() - (before ? 0 : 1);
  for (Index k = 0; k < updates; ++k) {
    const Batch<double> target =
        all.middleCols(k % (all.cols() / batch) * batch, batch);
    At at(l, theta, target, given_for(l, target));
    EXPECT_TRUE(same(at.loss.mean(), losses(k))) << "update " << k;
    at.update(step);
    theta = l.network.theirs(at.theta);
  }
  if (!before)
    EXPECT_TRUE(same(At(l, theta, all, given_for(l, all)).loss.mean(),
                     losses(updates)));
  EXPECT_TRUE(same.summary(theta, out.at("theta_final")));
}

TEST(HigReference, Oscillators) {
  const Learner l = oscillators();
  const std::vector<Index> sizes = {4, 20, 20, 20, 96};
  int seen = 0;
  const Json file = load_reference("hig-oscillators");
  for (const Json& e : file.at("entries")) {
    const std::string name = e.at("name");
    SCOPED_TRACE(name);
    if (name.starts_with("batch")) check_batch(l, sizes, "x0", e), ++seen;
    if (name.starts_with("sequence"))
      check_sequence(l, sizes, "x0", e.at("input").at("batch"), e), ++seen;
  }
  EXPECT_GE(seen, 5);
}

TEST(HigReference, FirstOrderRules) {
  int seen = 0;
  const Json file = load_reference("hig-oscillators");
  for (const Json& e : file.at("entries")) {
    if (e.at("name") != "first_order_rules") continue;
    const Json &in = e.at("input"), &out = e.at("expected");
    const auto same = HigTolerance(e).array();
    const double rate = in.at("lr");
    const std::map<std::string, StepOptions> rules = {
        {"sgd", SgdOptions{.rate = rate}},
        {"adam", AdamOptions{.rate = rate, .eps_before_correction = true}},
        {"adagrad", AdagradOptions{.rate = rate}},
        {"rmsprop", RmspropOptions{.rate = rate}},
        {"adadelta", AdadeltaOptions{.rate = rate}}};
    for (const auto& [name, options] : rules) {
      UpdateStep<double> step(options);
      Vector<double> theta = flat(in.at("theta"));
      for (std::size_t t = 0; t < in.at("grads").size(); ++t) {
        step(theta, flat(in.at("grads").at(t)));
        EXPECT_TRUE(same(theta, flat(out.at(name).at(t)))) << name << t;
      }
      ++seen;
    }
  }
  EXPECT_EQ(seen, 5);
}

TEST(HigReference, Poisson) {
  const Learner l = poisson();
  const std::vector<Index> sizes = {64, 64, 256, 64, 64};
  int seen = 0;
  const Json file = load_reference("hig-poisson");
  for (const Json& e : file.at("entries")) {
    const std::string name = e.at("name");
    SCOPED_TRACE(name);
    if (name.starts_with("batch")) check_batch(l, sizes, "rho", e), ++seen;
    if (name == "hig_three_updates")
      check_sequence(l, sizes, "rho", 2, e), ++seen;
    if (name != "adam_three_steps") continue;
    const Json &in = e.at("input"), &out = e.at("expected");
    const auto same = HigTolerance(e).array();
    const Batch<double> rho = columns(in.at("rho"));
    UpdateStep<double> step(
        AdamOptions{.rate = in.at("lr"), .eps_before_correction = true});
    Vector<double> theta = start_weights(in, sizes);
    const Vector<double> losses = flat(out.at("losses"));
    for (Index k = 0; k < losses.size(); ++k) {
      At at(l, theta, rho, given_for(l, rho));
      EXPECT_TRUE(same(at.loss.mean(), losses(k)));
      if (k + 1 < losses.size()) step(theta, at.gradient());
    }
    EXPECT_TRUE(same.summary(theta, out.at("theta_final")));
    ++seen;
  }
  EXPECT_GE(seen, 4);
}

TEST(HigReference, QuantumDipole) {
  const Learner l = quantum();
  int seen = 0;
  const Json file = load_reference("hig-quantum-dipole");
  for (const Json& e : file.at("entries"))
    if (const std::string name = e.at("name"); name.starts_with("fc_")) {
      SCOPED_TRACE(name);
      check_batch(l, {28, 20, 20, 20, 384}, "target", e), ++seen;
    }
  EXPECT_GE(seen, 2);
}

}  // namespace
}  // namespace physinv::test
