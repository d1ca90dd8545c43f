// hig-toy, whose Jacobian is tall, and the same network at its extremes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <regex>

#include "optimizers/steps/rule.h"
#include "problems/scaled_output/scaled_output.h"
#include "suite/core/any_problem.h"
#include "suite/nn/mlp.h"
#include "tests/optimizers/hig_learner.h"
#include "tests/support/singular_values.h"

namespace physinv::test {
namespace {

Learner toy(double gamma, double grad_scale = 2) {
  return {
      .problem = problems::scaled_output(ScaledOutputOptions{.gamma = gamma})
                     .make<double>(),
      .single = problems::scaled_output(ScaledOutputOptions{.gamma = gamma})
                    .make<float>(),
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
  const Json in = entry.at("input"), out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const Learner l = toy(in.at("gamma"));
  const Batch<double> x = toy_points(in.at("x"));
  At at(l, flat(in.at("theta"), 30), toy_targets(x), x);
  EXPECT_TRUE(same(at.x, flat_columns(out.at("y"))));
  EXPECT_TRUE(same(at.y, flat_columns(out.at("z"))));
  EXPECT_TRUE(same(at.loss.mean(), number(out.at("loss"))));
  EXPECT_TRUE(same(at.gradient(), flat(out.at("grad"))));
  const Batch<double> j = at.stacked_jacobian();
  EXPECT_TRUE(same(j.transpose(), flat_columns(out.at("jacobian"))));
  check_singular_values(j, at.g.reshaped(), flat(out.at("singular_values")));

  const Workspace::Scope scope(at.work);
  std::vector<LayerRows<double>> layers;
  by_rows(*l.network.net)
      .jacobian_rows(at.theta, at.tape, at.x, layers, at.work);
  ASSERT_EQ(layers.size(), 2U);
  const Batch<double> hidden = flat_columns(out.at("hidden"));
  ASSERT_EQ(layers[0].inputs, hidden.rows());
  const Eigen::Map<const Batch<double>, 0, Eigen::OuterStride<>> ours(
      layers[0].a, hidden.cols(), hidden.rows(), {layers[0].a_stride});
  EXPECT_TRUE(same(ours.transpose(), hidden));

  // In float, as far as float goes.
  const auto net = nn::mlp({.hidden = {7}, .activation = nn::Activation::tanh})
                       .make<float>(1, 2);
  const AnyProblem<float> problem(
      problems::scaled_output({.gamma = in.at("gamma")}));
  const Vector<float> theta =
      l.network.ours(flat(in.at("theta"), 30)).cast<float>();
  Batch<float> y(2, x.cols()), z(2, x.cols()), bar(2, x.cols());
  Tape tape;
  net->forward(theta, Vector<float>(), x.cast<float>(), y, tape, at.work);
  problem.forward(y, x.cast<float>(), z, at.work);
  EXPECT_TRUE(TwoNorm(2e-6, 0)(z, flat_columns(out.at("z"))));
  problem.loss_gradient(z, toy_targets(x).cast<float>(), bar);
  bar.row(1) *= in.at("gamma").get<float>();
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
  const Json in = entry.at("input"), out = entry.at("expected");
  const Batch<double> x = toy_points(in.at("x"));
  const double b = static_cast<double>(x.cols());
  const Learner l = toy(in.at("gamma"), in.at("scale").get<double>() * b);
  At at(l, flat(in.at("theta"), 30), toy_targets(x), x);
  const Vector<double> s = flat(out.at("singular_values"));
  check_singular_values(at.stacked_jacobian(), at.g.reshaped(), s);
  const Vector<double> theta = at.theta;
  int compared = 0;
  for (const std::string& key : out.keys()) {
    if (key == "singular_values") continue;
    const Json stored = out.at(key);
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
    const Index kept = stored.at("kept");
    if (clear) {
      EXPECT_EQ(report.kept, kept);
    }
    // Updates can be compared where every value is clear of its cut.
    const Vector<double> delta = flat(stored.at("delta"));
    const auto same = HigTolerance(entry).delta(true);
    if (cut != 0 && ((s.array() - cut).abs() <= 1e-6 * cut).any()) continue;
    EXPECT_TRUE(same(update, delta));
    ++compared;
  }
  EXPECT_GE(compared, 1) << "every update hangs on a value next to its cut";
}

void check_toy_trajectory(const Json& entry) {
  const Json in = entry.at("input"), out = entry.at("expected");
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
  const double tau = in.at("tau");  // null with Adam
  if (!adam) options.power = {.kappa = in.at("kappa"), .tau = tau};
  HalfInverseStep<double> step(options);
  Vector<double> theta = flat(in.at("theta"), 30);
  const Batch<double> thetas = columns(out.at("theta_after"));
  const Vector<double> losses = flat(out.at("batch_loss_before"));
  ASSERT_TRUE(1 <= batch && batch <= all.cols()) << "batch " << batch;
  ASSERT_EQ(thetas.cols(), losses.size());
  for (Index k = 0; k < thetas.cols(); ++k) {
    SCOPED_TRACE(k);
    const Batch<double> x =
        all.middleCols(k % (all.cols() / batch) * batch, batch);
    At at(l, theta, toy_targets(x), x);
    EXPECT_TRUE(same(at.loss.mean(), losses(k)));
    if (adam) {
      first_order(theta, at.gradient());
    } else {
      at.update(step);
      theta = l.network.theirs(at.theta);
    }
    EXPECT_TRUE(same(theta, thetas.col(k)));
  }
}

TEST(HigReference, Toy) {
  check_entries("hig-toy",
                {{"forward_*", check_toy_forward},
                 {"updates_*", check_toy_updates},
                 {"trajectory_*", check_toy_trajectory}});
}

/// The definition by Eigen's singular value decomposition of the whole J.
Vector<double> defined_update(const Batch<double>& j,
                              const Vector<double>& g,
                              const hig::Power& power) {
  const linalg::SingularValues svd = jacobi_singular_values(j);
  const Vector<double>& s = svd.s;
  const double cut = power.absolute ? power.tau : power.tau * s(0);
  Vector<double> c = svd.u.transpose() * g;
  for (Index i = 0; i < s.size(); ++i)
    c(i) *= s(i) > cut ? std::pow(s(i), power.kappa) : 0;
  return svd.v * c;
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
  const Json start(Json::Raw{{"weights_offset", 77}});
  const Vector<double> fresh = toy(1).network.start(start);
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
      const Batch<double> j = at.stacked_jacobian();
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

}  // namespace
}  // namespace physinv::test
