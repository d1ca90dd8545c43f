#include "tests/optimizers/hig_learner.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <stdexcept>

#include "suite/core/gradient_projection.h"
#include "suite/linalg/decompositions.h"
#include "suite/nn/mlp.h"

namespace physinv::test {

Ordered::Ordered(const std::vector<Index>& sizes, nn::Activation activation) {
  const auto recipe = nn::mlp({.hidden = {sizes.begin() + 1, sizes.end() - 1},
                               .activation = activation});
  net = recipe.make<double>(sizes.front(), sizes.back());
  single = recipe.make<float>(sizes.front(), sizes.back());
  for (std::size_t l = 0; l + 1 < sizes.size(); ++l)
    layers_.push_back({1, sizes[l], sizes[l + 1]});
}

Ordered::Ordered(const nn::CnnOptions& o, Index outputs) {
  const auto recipe = nn::cnn(o);
  net = recipe.make<double>(o.positions * o.channels, outputs);
  single = recipe.make<float>(o.positions * o.channels, outputs);
  Index in = o.channels, positions = o.positions;
  for (const Index out : o.features) {
    layers_.push_back({o.taps, in, out});
    in = out, positions -= o.taps - 1;
  }
  layers_.push_back({1, positions * in, outputs});
}

Vector<double> Ordered::start(const Json& in) const {
  const double gain = in.value("weight_gain", 1.0);
  const double bias_scale = in.value("bias_scale", 0.1);
  Vector<double> theta = hig_probe(
      net->parameter_count(), in.at("weights_offset").get<std::uint32_t>());
  Index at = 0;
  for (const auto& [taps, inputs, outputs] : layers_) {
    const Index size = taps * inputs * outputs;
    const auto fans = static_cast<double>(taps * (inputs + outputs));
    theta.segment(at, size) *= gain * std::sqrt(6 / fans);
    theta.segment(at + size, outputs) *= bias_scale;
    at += size + outputs;
  }
  return theta;
}

Vector<double> Ordered::permuted(const Vector<double>& from, bool back) const {
  Vector<double> to = from;
  if (from.size() != net->parameter_count()) return to;  // `At` says so
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

At::At(const Learner& l,
       const Vector<double>& theirs,
       const Batch<double>& wanted,
       const Batch<double>& side)
    : learner(l),
      theta(l.network.ours(theirs)),
      in(l.input_is_given ? side : wanted),
      given(side),
      target(wanted) {
  const Shape shape = l.problem->shape();
  const Index n = target.cols();
  if (target.rows() != shape.observations ||
      theta.size() != l.network.net->parameter_count())
    throw std::runtime_error(
        fmt::format("targets of {} numbers, {} weights; the test has {} and {}",
                    target.rows(),
                    theta.size(),
                    shape.observations,
                    l.network.net->parameter_count()));
  const Network<double>& net = *l.network.net;
  x.resize(shape.unknowns, n), y.resize(shape.observations, n);
  g.resizeLike(y), loss.resize(n);
  jacobian.resize(y.rows() * x.rows(), n);
  net.forward(theta, Vector<double>(), in, x, tape, work, {.training = true});
  l.problem->forward({x, given}, y, work);
  l.problem->loss(y, target, loss);
  l.problem->loss_gradient(y, target, g);
  dynamic_cast<const Jacobian<double>&>(*l.problem)
      .jacobian({x, given}, jacobian, work);
  mean_gradient = g / static_cast<double>(n);
  g *= l.factor(n);
  if (auto* p =
          dynamic_cast<const GradientProjection<double>*>(l.problem.get()))
    p->project(y, g);
}

At::At(const Learner& l,
       const Vector<double>& theirs,
       const Batch<double>& wanted)
    : At(l,
         theirs,
         wanted,
         l.given_is_target ? wanted : Batch<double>(0, wanted.cols())) {}

Vector<double> At::gradient() {
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

Vector<double> At::update(HalfInverseStep<double>& step) {
  EXPECT_TRUE(step(*learner.network.net, theta, tape, jacobian, g, work));
  return learner.network.theirs(step.update());
}

Vector<double> At::update_in_float(
    const HalfInverseStepOptions& options) const {
  const Network<float>& net = *learner.network.single;
  const Problem<float>& solver = *learner.single;
  Vector<float> weights = theta.cast<float>();
  Batch<float> x1 = x.cast<float>(), y1 = y.cast<float>(), g1 = y1;
  Batch<float> j1 = jacobian.cast<float>();
  const Batch<float> given1 = given.cast<float>(), in1 = in.cast<float>();
  Tape tape1;
  Workspace work1;
  net.forward(
      weights, Vector<float>(), in1, x1, tape1, work1, {.training = true});
  solver.forward({x1, given1}, y1, work1);
  solver.loss_gradient(y1, target.cast<float>(), g1);
  dynamic_cast<const Jacobian<float>&>(solver).jacobian(
      {x1, given1}, j1, work1);
  g1 *= static_cast<float>(learner.factor(x.cols()));
  if (auto* p = dynamic_cast<const GradientProjection<float>*>(&solver))
    p->project(y1, g1);
  HalfInverseStep<float> step(options);
  EXPECT_TRUE(step(net, weights, tape1, j1, g1, work1));
  return learner.network.theirs(step.update());
}

Batch<double> At::stacked_jacobian() {
  const Index per = y.rows(), n = y.cols();
  Batch<double> rows(per * n, theta.size());
  Batch<double> x_bar(x.rows(), n);
  Vector<double> bar(theta.size());
  for (Index r = 0; r < rows.rows(); ++r) {
    const Index i = r / per;
    x_bar.setZero();
    x_bar.col(i) = Eigen::Map<const Batch<double>>(
                       jacobian.col(i).data(), per, x_bar.rows())
                       .row(r % per)
                       .transpose();
    VectorOut<double> out(bar);
    learner.network.net->backward(theta, tape, x_bar, &out, nullptr, work);
    rows.row(r) = learner.network.theirs(bar).transpose();
  }
  return rows;
}

Batch<double> flat_columns(const Json& list) {
  const Vector<double> all = flat(list);
  const auto n = static_cast<Index>(list.size());
  if (n == 0 || all.size() % n != 0)
    throw std::runtime_error(fmt::format(
        "{} has {} numbers in {} items", list.path(), all.size(), n));
  return Eigen::Map<const Batch<double>>(all.data(), all.size() / n, n);
}

bool parse_power(const std::string& key, hig::Power& power) {
  static const std::regex form(
      "delta_k([-0-9.]+)_tau([-0-9.e]+)(?:_beta([-0-9.]+))?");
  std::smatch part;
  if (!std::regex_match(key, part, form)) return false;
  power = {.kappa = std::stod(part[1]),
           .tau = std::stod(part[2]),
           .beta = part[3].matched ? std::stod(part[3]) : 0};
  return true;
}

namespace {

/// An update by the library's tolerance and by the strictest, and what either
/// keeps.
void check_update(At& at,
                  const HigTolerance& tolerance,
                  const hig::Power& power,
                  const Vector<double>& s,
                  const Json& stored) {
  const Vector<double> before = at.theta;
  EXPECT_TRUE(TwoNorm(at.learner.in_float, 0)
                  .summary(at.update_in_float({.power = power}), stored));
  const double cut = power.tau * s(0);
  for (const bool strict : {false, true}) {
    HalfInverseStepOptions options{.power = power};
    if (strict) options.numerics.tolerance = 1e-8;
    HalfInverseStep<double> step(options);
    EXPECT_TRUE(tolerance.delta(strict).summary(at.update(step), stored));
    at.theta = before;
    // Where no value is so close to its cut that rounding decides.
    const Index kept = stored.at("kept");
    const double doubt =
        strict ? 1e-14 / power.tau : 1e-15 / (power.tau * power.tau);
    const bool clear =
        power.tau == 0 || ((s.array() - cut).abs() > doubt * cut).all();
    if (clear && power.kappa != 1) {
      EXPECT_EQ(step.report().kept, kept);
      // Without a spectrum it is a bound.
      EXPECT_GE(step.report().s_max, (1 - 1e-10) * s(0));
      if (step.report().path != hig::Path::shortcut) {
        EXPECT_LE(step.report().s_max, (1 + 1e-10) * s(0));
      }
    }
  }
}

}  // namespace

void check_batch(const Learner& l, const char* targets, const Json& entry) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const HigTolerance tolerance(entry);
  const auto same = tolerance.array();
  At at(l, l.network.start(in), flat_columns(in.at(targets)));
  ASSERT_EQ(at.target.cols(), in.at("batch").get<Index>());
  if (out.contains("loss")) {
    EXPECT_TRUE(same(at.loss.mean(), number(out.at("loss"))));
  }
  if (out.contains("loss_sum")) {
    EXPECT_TRUE(same(at.loss.sum(), number(out.at("loss_sum"))));
    EXPECT_TRUE(same(at.loss.mean(), number(out.at("loss_mean"))));
  }
  for (const char* state : {"y", "psi"}) {
    if (out.contains(state)) {
      EXPECT_TRUE(same(at.y, flat_columns(out.at(state))));
    }
  }
  for (const char* estimate : {"control_first", "phi_first"}) {
    if (out.contains(estimate)) {
      EXPECT_TRUE(same(at.x.col(0), flat(out.at(estimate))));
    }
  }
  if (out.contains("laplace_first")) {
    EXPECT_TRUE(same(at.y.col(0), flat(out.at("laplace_first"))));
  }
  const char* gradient = out.contains("grad_loss") ? "grad_loss" : "grad_mean";
  EXPECT_TRUE(same.summary(at.gradient(), out.at(gradient)));

  const Vector<double> expected = flat(out.at("singular_values"));
  const Batch<double> j = at.stacked_jacobian();
  const Vector<double> s = linalg::singular_values(j).s;
  ASSERT_EQ(s.size(), expected.size());
  EXPECT_LE((s - expected).cwiseAbs().maxCoeff(), 1e-12 * expected(0));

  int updates = 0;
  for (const std::string& key : out.keys()) {
    hig::Power power;
    if (!parse_power(key, power)) continue;
    SCOPED_TRACE(key);
    check_update(at, tolerance, power, expected, out.at(key));
    ++updates;
  }
  EXPECT_GE(updates, 1);
}

void check_sequence(const Learner& l,
                    const char* targets,
                    Index batch,
                    const Json& entry) {
  const Json in = entry.at("input"), out = entry.at("expected");
  const HigTolerance tolerance(entry);
  const auto same = tolerance.array();
  const Batch<double> all = flat_columns(in.at(targets));
  ASSERT_TRUE(1 <= batch && batch <= all.cols()) << "batch " << batch;
  const Vector<double> start = l.network.start(in);
  const bool before = out.contains("losses_before");
  const Vector<double> losses =
      flat(out.at(before ? "losses_before" : "losses"));
  const Index updates = losses.size() - (before ? 0 : 1);
  const auto run = [&](double numerics, const auto& near) {
    HalfInverseStep<double> step(
        {.power = {.kappa = in.value("kappa", -0.5), .tau = in.at("tau")},
         .rate = in.at("eta"),
         .numerics = {.tolerance = numerics}});
    Vector<double> theta = start;
    for (Index k = 0; k < updates; ++k) {
      const Batch<double> target =
          all.middleCols(k % (all.cols() / batch) * batch, batch);
      At at(l, theta, target);
      EXPECT_TRUE(near(at.loss.mean(), losses(k))) << "update " << k;
      at.update(step);
      theta = l.network.theirs(at.theta);
    }
    if (!before) {
      EXPECT_TRUE(near(At(l, theta, all).loss.mean(), losses(updates)));
    }
    return theta;
  };
  const Vector<double> strict = run(1e-8, same);
  EXPECT_TRUE(same.summary(strict, out.at("theta_final")));
  const hig::HalfInverseOptions own;
  const Vector<double> ours = run(own.tolerance, TwoNorm(own.tolerance, 1e-12));
  EXPECT_LE((ours - strict).norm(), own.tolerance * (strict - start).norm());
}

}  // namespace physinv::test
