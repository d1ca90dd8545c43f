// The reference files' updates of network and solver together: loss, gradient
// and powers of the stacked Jacobian at given weights, and short trainings.
#include "tests/support/hig_reference.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <regex>

#include "optimizers/half_inverse_step.h"
#include "optimizers/steps/rule.h"
#include "problems/grid_poisson/grid_poisson.h"
#include "problems/oscillators/oscillators.h"
#include "problems/quantum_dipole/quantum_dipole.h"
#include "problems/scaled_output/scaled_output.h"
#include "suite/nn/cnn.h"
#include "suite/nn/mlp.h"

namespace physinv::test {
namespace {

/// A network whose flat vectors are the files': weights [tap][in][out].
class Ordered {
 public:
  Ordered(const std::vector<Index>& sizes, nn::Activation activation) {
    net = nn::mlp({.hidden = {sizes.begin() + 1, sizes.end() - 1},
                   .activation = activation})
              .make<double>(sizes.front(), sizes.back());
    for (std::size_t l = 0; l + 1 < sizes.size(); ++l)
      layers_.push_back({1, sizes[l], sizes[l + 1]});
  }
  explicit Ordered(const nn::CnnOptions& o, Index outputs) {
    net = nn::cnn(o).make<double>(o.positions * o.channels, outputs);
    Index in = o.channels, positions = o.positions;
    for (const Index out : o.features) {
      layers_.push_back({o.taps, in, out});
      in = out, positions -= o.taps - 1;
    }
    layers_.push_back({1, positions * in, outputs});
  }

  Vector<double> ours(const Vector<double>& theirs) const {
    return permuted(theirs, false);
  }
  Vector<double> theirs(const Vector<double>& ours) const {
    return permuted(ours, true);
  }
  /// Bounds of the weights, in the files' order.
  std::vector<HigTensor> tensors(double gain, double bias_scale) const {
    std::vector<HigTensor> all;
    for (const auto& [taps, in, out] : layers_) {
      const auto fans = static_cast<double>(taps * (in + out));
      all.push_back({taps * in * out, gain * std::sqrt(6 / fans)});
      all.push_back({out, bias_scale});
    }
    return all;
  }

  std::unique_ptr<Network<double>> net;

 private:
  struct Layer {
    Index taps, in, out;
  };

  Vector<double> permuted(const Vector<double>& from, bool back) const {
    Vector<double> to = from;
    Index at = 0;
    for (const auto& [taps, in, out] : layers_) {
      for (Index t = 0; t < taps; ++t)
        for (Index i = 0; i < in; ++i)
          for (Index o = 0; o < out; ++o) {
            const Index mine = at + (o * in + i) * taps + t;
            const Index other = at + (t * in + i) * out + o;
            to(back ? other : mine) = from(back ? mine : other);
          }
      at += taps * in * out + out;
    }
    return to;
  }

  std::vector<Layer> layers_;
};

/// One experiment of the files.
struct Learner {
  std::unique_ptr<Problem<double>> problem;
  Ordered network;
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
                 const Vector<double>& start,
                 const char* targets,
                 const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const HigTolerance tolerance(entry);
  const auto same = tolerance.array();
  const Batch<double> target = columns(in.at(targets));
  At at(l, start, target, given_for(l, target));
  if (out.contains("loss")) {
    EXPECT_TRUE(same(at.loss.mean(), out.at("loss")));
  }
  if (out.contains("loss_sum")) {
    EXPECT_TRUE(same(at.loss.sum(), out.at("loss_sum")));
  }
  for (const char* state : {"y", "psi"}) {
    if (out.contains(state)) {
      EXPECT_TRUE(same(at.y, columns(out.at(state))));
    }
  }
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

void check_batch(const Learner& l,
                 const std::vector<Index>& sizes,
                 const char* targets,
                 const Json& entry) {
  check_batch(l, start_weights(entry.at("input"), sizes), targets, entry);
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
  if (!before) {
    EXPECT_TRUE(same(At(l, theta, all, given_for(l, all)).loss.mean(),
                     losses(updates)));
  }
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

Learner toy(double gamma, double grad_scale = 2) {
  return {
      .problem = std::make_unique<ScaledOutput<double>>(
          ScaledOutputOptions{.gamma = gamma}),
      .network = {{1, 7, 2}, nn::Activation::tanh},
      .factor = [=](Index b) { return grad_scale / static_cast<double>(b); },
      .input_is_given = true};
}

/// (sin 6x, cos 9x)
Batch<double> toy_targets(const Batch<double>& x) {
  Batch<double> t(2, x.cols());
  t.row(0) = (6 * x.array()).sin();
  t.row(1) = (9 * x.array()).cos();
  return t;
}

Batch<double> toy_points(const Json& list) { return flat(list).transpose(); }

/// Row by row from backward passes, unlike every path of the library.
Batch<double> stacked_jacobian(At& at) {
  const Index per = at.y.rows(), n = at.y.cols();
  Batch<double> rows(per * n, at.theta.size());
  Batch<double> x_bar(at.x.rows(), n);
  Vector<double> bar(at.theta.size());
  for (Index r = 0; r < rows.rows(); ++r) {
    const Index i = r / per;
    x_bar.setZero();
    x_bar.col(i) = Eigen::Map<const Batch<double>>(
                       at.jacobian.col(i).data(), per, x_bar.rows())
                       .row(r % per)
                       .transpose();
    VectorOut<double> out(bar);
    at.learner.network.net->backward(
        at.theta, at.tape, x_bar, &out, nullptr, at.work);
    rows.row(r) = at.learner.network.theirs(bar).transpose();
  }
  return rows;
}

void check_singular_values(const Batch<double>& j,
                           const Vector<double>& g,
                           const Vector<double>& expected) {
  hig::ExplicitPower power;
  ASSERT_EQ(power.factor(j, g), hig::Ending::ok);
  Vector<double> s(power.spectrum().lambda.size());
  for (Index i = 0; i < s.size(); ++i) s(i) = power.spectrum().s(i);
  std::sort(s.begin(), s.end(), std::greater<>());
  ASSERT_EQ(s.size(), expected.size());
  EXPECT_LE((s - expected).cwiseAbs().maxCoeff(), 1e-12 * expected(0));
}

void check_toy_forward(const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const Learner l = toy(in.at("gamma"));
  const Batch<double> x = toy_points(in.at("x"));
  At at(l, flat(in.at("theta")), toy_targets(x), x);
  EXPECT_TRUE(same(at.x, columns(out.at("y"))));
  EXPECT_TRUE(same(at.y, columns(out.at("z"))));
  EXPECT_TRUE(same(at.loss.mean(), out.at("loss")));
  EXPECT_TRUE(same(at.gradient(), flat(out.at("grad"))));
  const Batch<double> j = stacked_jacobian(at);
  EXPECT_TRUE(same(j.transpose(), columns(out.at("jacobian"))));
  check_singular_values(j, at.g.reshaped(), flat(out.at("singular_values")));

  const Workspace::Scope scope(at.work);
  std::vector<LayerRows<double>> layers;
  l.network.net->jacobian_rows(at.theta, at.tape, at.x, layers, at.work);
  ASSERT_EQ(layers.size(), 2U);
  const Batch<double> hidden = columns(out.at("hidden"));
  ASSERT_EQ(layers[0].inputs, hidden.rows());
  const Eigen::Map<const Batch<double>, 0, Eigen::OuterStride<>> ours(
      layers[0].a, hidden.cols(), hidden.rows(), {layers[0].a_stride});
  EXPECT_TRUE(same(ours.transpose(), hidden));

  // In float, as far as float goes.
  const auto net = nn::mlp({.hidden = {7}, .activation = nn::Activation::tanh})
                       .make<float>(1, 2);
  const ScaledOutput<float> problem({.gamma = in.at("gamma")});
  const Vector<float> theta =
      l.network.ours(flat(in.at("theta"))).cast<float>();
  Batch<float> y(2, x.cols()), z(2, x.cols()), bar(2, x.cols());
  Tape tape;
  net->forward(theta, Vector<float>(), x.cast<float>(), y, tape, at.work);
  problem.forward(y, x.cast<float>(), z, at.work);
  EXPECT_TRUE(TwoNorm(2e-6, 0)(z, columns(out.at("z"))));
  problem.loss_gradient(z, toy_targets(x).cast<float>(), bar);
  bar.row(1) *= static_cast<float>(in.at("gamma").get<double>());
  bar /= static_cast<float>(x.cols());
  Vector<float> gradient(theta.size());
  VectorOut<float> to(gradient);
  net->backward(theta, tape, bar, &to, nullptr, at.work);
  EXPECT_TRUE(TwoNorm(5e-6, 0)(l.network.theirs(gradient.cast<double>()),
                               flat(out.at("grad"))));
}

/// kappa-0.5_tau1e-06_absolute
hig::Power toy_power(const std::string& key) {
  static const std::regex form(
      "kappa([-0-9.]+)_tau([-0-9.e]+)_(absolute|relative)");
  std::smatch part;
  if (!std::regex_match(key, part, form))
    throw std::runtime_error("unknown entry " + key);
  return {.kappa = std::stod(part[1]),
          .tau = std::stod(part[2]),
          .absolute = part[3] == "absolute"};
}

void check_toy_updates(const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const Batch<double> x = toy_points(in.at("x"));
  const double b = static_cast<double>(x.cols());
  const Learner l = toy(in.at("gamma"), in.at("scale").get<double>() * b);
  At at(l, flat(in.at("theta")), toy_targets(x), x);
  const Vector<double> s = flat(out.at("singular_values"));
  check_singular_values(stacked_jacobian(at), at.g.reshaped(), s);
  const Vector<double> theta = at.theta;
  for (const auto& [key, stored] : out.items()) {
    if (key == "singular_values") continue;
    SCOPED_TRACE(key);
    const hig::Power power = toy_power(key);
    HalfInverseStep<double> step({.power = power});
    const Vector<double> update = at.update(step);
    at.theta = theta;
    const auto& report = step.report();
    // Without a cut, what is kept may be noise.
    EXPECT_TRUE(report.proven || power.tau == 0);
    EXPECT_NEAR(report.s_max, s(0), 1e-12 * s(0));
    // Every value must be clear of its cut, in units of the rounding of J.
    const double cut = power.absolute ? power.tau : power.tau * s(0);
    const bool clear =
        cut == 0 ? s.minCoeff() > 1e-14 * s(0)
                 : ((s.array() - cut).abs() > 1e-14 / power.tau * cut).all();
    if (clear) {
      EXPECT_EQ(report.kept, stored.at("kept").get<Index>());
    }
    // The file compares updates only where this holds.
    EXPECT_TRUE(cut == 0 || ((s.array() - cut).abs() > 1e-6 * cut).all());
    EXPECT_TRUE(
        HigTolerance(entry).delta(true)(update, flat(stored.at("delta"))));
  }
}

void check_toy_trajectory(const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const Learner l = toy(in.at("gamma"));
  const Batch<double> all = toy_points(in.at("x"));
  const Index batch = in.at("batch");
  const bool adam = in.at("kappa").is_null();
  const double rate = in.at("eta");
  UpdateStep<double> first_order(
      AdamOptions{.rate = rate, .eps_before_correction = true});
  // A wide Jacobian of 16 rows; nothing may be squared here.
  HalfInverseStepOptions options{.rate = rate, .numerics = {.tolerance = 0}};
  if (!adam) options.power = {.kappa = in.at("kappa"), .tau = in.at("tau")};
  HalfInverseStep<double> step(options);
  Vector<double> theta = flat(in.at("theta"));
  const Json &thetas = out.at("theta_after"),
             &losses = out.at("batch_loss_before");
  ASSERT_EQ(thetas.size(), 8U);
  for (Index k = 0; k < 8; ++k) {
    SCOPED_TRACE(k);
    const Batch<double> x =
        all.middleCols(k % (all.cols() / batch) * batch, batch);
    At at(l, theta, toy_targets(x), x);
    const auto item = static_cast<std::size_t>(k);
    EXPECT_TRUE(same(at.loss.mean(), losses.at(item)));
    if (adam) {
      first_order(theta, at.gradient());
    } else {
      at.update(step);
      theta = l.network.theirs(at.theta);
    }
    EXPECT_TRUE(same(theta, flat(thetas.at(item))));
  }
}

TEST(HigReference, Toy) {
  int seen = 0;
  const Json file = load_reference("hig-toy");
  for (const Json& e : file.at("entries")) {
    const std::string name = e.at("name");
    SCOPED_TRACE(name);
    if (name.starts_with("forward")) {
      check_toy_forward(e);
    } else if (name.starts_with("updates")) {
      check_toy_updates(e);
    } else if (name.starts_with("trajectory")) {
      check_toy_trajectory(e);
    } else {
      ADD_FAILURE() << "unknown entry";
    }
    ++seen;
  }
  EXPECT_EQ(seen, 7);
}

/// The definition by Eigen's singular value decomposition of the whole J.
Vector<double> defined_update(const Batch<double>& j,
                              const Vector<double>& g,
                              const hig::Power& power) {
  const Eigen::JacobiSVD<Batch<double>> svd(
      j, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Vector<double>& s = svd.singularValues();
  const double cut = power.absolute ? power.tau : power.tau * s(0);
  Vector<double> c = svd.matrixU().transpose() * g;
  for (Index i = 0; i < s.size(); ++i)
    c(i) *= s(i) > cut ? std::pow(s(i), power.kappa) : 0;
  return svd.matrixV() * c;
}

constexpr hig::Power kGaussNewton{.kappa = -1, .tau = 1e-4};
constexpr hig::Power kHalfInverse{.kappa = -0.5, .tau = 1e-6};

Batch<double> spread_points(Index count) {
  return Vector<double>::LinSpaced(count, -0.97, 0.93).transpose();
}

// Only the output biases act: s = (sqrt b, gamma sqrt b).
TEST(HigReference, ToyWithAllWeightsZero) {
  constexpr double kGamma = 0.01;
  const Learner l = toy(kGamma);
  for (const Index b : {1, 12, 256}) {
    SCOPED_TRACE(b);
    const Batch<double> x = spread_points(b), t = toy_targets(x);
    At at(l, Vector<double>::Zero(30), t, x);
    HalfInverseStep<double> step(
        {.power = kHalfInverse, .numerics = {.tolerance = 0}});
    const Vector<double> update = at.update(step);
    EXPECT_EQ(step.report().kept, 2);
    const double root = std::sqrt(static_cast<double>(b));
    EXPECT_NEAR(step.report().s_max, root, 1e-14 * root);
    EXPECT_NEAR(step.report().smallest_kept, kGamma * root, 1e-15 * root);
    // update = s^(-1/2) times g by the unit vector of ones.
    Vector<double> expected = Vector<double>::Zero(30);
    const double shrink = 1 / (root * std::sqrt(root));
    expected(28) = at.g.row(0).sum() * shrink;
    expected(29) = at.g.row(1).sum() * shrink / std::sqrt(kGamma);
    EXPECT_TRUE(TwoNorm(1e-12, 0)(update, expected));
  }
}

// Saturated neurons, repeated points, a second component below the cut, one
// sample: all of them against the definition.
TEST(HigReference, ToyAtItsExtremes) {
  const Vector<double> fresh = start_weights(Json::parse(R"(
      {"weight_gain": 1.0, "bias_scale": 0.1, "weights_offset": 77})"),
                                             {1, 7, 2});
  Vector<double> saturated = fresh;
  saturated.segment(2, 3) *= 3000;
  Vector<double> dead = fresh;
  dead.segment(14, 4).setZero();
  Batch<double> repeated = spread_points(64);
  for (Index i = 0; i < 64; ++i) repeated(0, i) = 0.1 * double(i % 3);
  struct Extreme {
    const char* name;
    Vector<double> theta;
    Batch<double> x;
    double gamma;
  };
  const std::vector<Extreme> extremes = {
      {"saturated", saturated, spread_points(256), 0.01},
      {"no weights behind two neurons", dead, spread_points(256), 0.01},
      {"repeated points", fresh, repeated, 0.01},
      {"second component unseen", fresh, spread_points(256), 1e-12},
      {"one sample", fresh, spread_points(1), 1},
      {"hardly tall", fresh, spread_points(16), 0.1},
      {"an odd number", fresh, spread_points(101), 0.1}};
  for (const Extreme& e : extremes) {
    for (const hig::Power& power : {kHalfInverse, kGaussNewton}) {
      SCOPED_TRACE(e.name);
      const Learner l = toy(e.gamma);
      At at(l, e.theta, toy_targets(e.x), e.x);
      const Batch<double> j = stacked_jacobian(at);
      HalfInverseStep<double> step(
          {.power = power, .numerics = {.tolerance = 0}});
      const Vector<double> update = at.update(step);
      EXPECT_TRUE(
          TwoNorm(1e-8, 0)(update, defined_update(j, at.g.reshaped(), power)));
    }
  }
}

TEST(HigReference, ToyWithoutAResidual) {
  const Learner l = toy(0.01);
  const Batch<double> x = spread_points(256);
  At at(l, Vector<double>::Constant(30, 0.3), toy_targets(x), x);
  at.g.setZero();
  const Vector<double> before = at.theta;
  HalfInverseStep<double> step({.power = kHalfInverse});
  EXPECT_TRUE(at.update(step).isZero(0));
  EXPECT_TRUE((at.theta.array() == before.array()).all());
  EXPECT_EQ(step.report().ending, hig::Ending::zero);
}

TEST(HigReference, ToyThatOverflows) {
  const Learner l = toy(0.01);
  const Batch<double> x = spread_points(256);
  Vector<double> theta = Vector<double>::Constant(30, 0.3);
  theta(14) = std::numeric_limits<double>::infinity();
  At at(l, theta, toy_targets(x), x);
  const Vector<double> before = at.theta;
  HalfInverseStep<double> step({.power = kHalfInverse});
  EXPECT_FALSE(
      step(*l.network.net, at.theta, at.tape, at.jacobian, at.g, at.work));
  EXPECT_TRUE((at.theta.array() == before.array()).all());
}

Learner quantum(const std::string& network) {
  return {
      .problem = std::make_unique<QuantumDipole<double>>(),
      .network =
          network == "fc"
              ? Ordered({28, 20, 20, 20, 384}, nn::Activation::tanh)
              : Ordered(nn::CnnOptions{.positions = 14,
                                       .channels = 2,
                                       .features = std::vector<Index>(6, 20)},
                        384),
      .factor = [](Index b) { return 1.0 / static_cast<double>(b); }};
}

void check_quantum_batch(const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const Learner l = quantum(in.at("network"));
  const Vector<double> start =
      hig_weights(l.network.tensors(in.at("weight_gain"), in.at("bias_scale")),
                  in.at("weights_offset").get<std::uint32_t>());
  check_batch(l, start, "target", entry);

  const Batch<double> target = columns(in.at("target"));
  At at(l, start, target, given_for(l, target));
  EXPECT_EQ(at.theta.size(), out.at("parameters").get<Index>());
  EXPECT_TRUE(same(at.x.col(0)(Eigen::seqN(0, 24, 16)).eval(),
                   flat(out.at("control_first_every16"))));
  EXPECT_TRUE(same(at.x.colwise().norm().transpose().eval(),
                   flat(out.at("control_norm"))));
  EXPECT_TRUE(same(at.loss, flat(out.at("loss_each"))));
  // Before the projection.
  EXPECT_TRUE(same(at.mean_gradient.reshaped(), flat(out.at("g"))));
  const QuantumDipole<double> box;
  Vector<double> level(target.cols());
  box.level_loss(2, at.y, target, level);
  EXPECT_TRUE(same(level.mean(), out.at("low_energy_loss")));
  box.level_loss(3, at.y, target, level);
  EXPECT_TRUE(same(level.mean(), out.at("high_energy_loss")));

  const Batch<double> j = stacked_jacobian(at);
  const Vector<double> s = Eigen::BDCSVD<Batch<double>>(j).singularValues();
  EXPECT_LE((s - flat(out.at("singular_values"))).cwiseAbs().maxCoeff(),
            1e-10 * s(0));
  for (const auto& [key, stored] : out.items()) {
    hig::Power power;
    if (!parse(key, power)) continue;
    HalfInverseStep<double> step({.power = power});
    const Vector<double> before = at.theta;
    at.update(step);
    at.theta = before;
    EXPECT_EQ(step.report().kept, stored.at("kept").get<Index>()) << key;
    EXPECT_NEAR(step.report().s_max, s(0), 1e-10 * s(0)) << key;
  }
}

/// A control without a network, by the method's own stage.
void check_direct(const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const Batch<double> target = flat(in.at("target"));
  const QuantumDipole<double> box;
  Batch<double> x = flat(in.at("u0")), y(28, 1), g(28, 1), s(28 * 384, 1);
  Vector<double> loss(1), update(384);
  const Batch<double> given(0, 1);
  Workspace work;
  const Vector<double> losses = flat(out.at("losses"));
  const Index updates = in.at("updates");
  ASSERT_EQ(losses.size(), updates + 1);
  hig::ExplicitPower power;
  for (Index k = 0; k <= updates; ++k) {
    box.forward(x, given, y, work);
    box.loss(y, target, loss);
    EXPECT_TRUE(same(loss(0), losses(k))) << "update " << k;
    if (k == updates) break;
    box.loss_gradient(y, target, g);
    box.project(y, g);
    box.jacobian(x, given, s, work);
    power.factor(s.reshaped(28, 384), g.col(0));
    power.apply({.kappa = in.at("kappa"), .tau = in.at("tau")}, update);
    x.col(0) -= in.at("eta").get<double>() * update;
  }
  EXPECT_TRUE(same(x.col(0), flat(out.at("u_final"))));
}

// The solver's own entries: tests/problems/quantum_dipole_reference_test.cpp.
TEST(HigReference, QuantumDipole) {
  const std::set<std::string> solver = {
      "eigenstates", "solver_random", "solver_zero"};
  int batches = 0, direct = 0;
  const Json file = load_reference("hig-quantum-dipole");
  for (const Json& e : file.at("entries")) {
    const std::string name = e.at("name");
    SCOPED_TRACE(name);
    if (solver.contains(name)) continue;
    if (name == "pure_hig") {
      check_direct(e), ++direct;
    } else {
      ASSERT_TRUE(name.starts_with("fc_") || name.starts_with("cnn_"))
          << "no test reads this entry";
      check_quantum_batch(e), ++batches;
    }
  }
  EXPECT_GE(batches, 3);
  EXPECT_GE(direct, 1);
}

}  // namespace
}  // namespace physinv::test
