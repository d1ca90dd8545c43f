#include "tests/optimizers/hig_learner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "suite/nn/mlp.h"

namespace physinv::test {

Ordered::Ordered(const std::vector<Index>& sizes, nn::Activation activation) {
  net = nn::mlp({.hidden = {sizes.begin() + 1, sizes.end() - 1},
                 .activation = activation})
            .make<double>(sizes.front(), sizes.back());
  for (std::size_t l = 0; l + 1 < sizes.size(); ++l)
    layers_.push_back({1, sizes[l], sizes[l + 1]});
}

Ordered::Ordered(const nn::CnnOptions& o, Index outputs) {
  net = nn::cnn(o).make<double>(o.positions * o.channels, outputs);
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

At::At(const Learner& l,
       const Vector<double>& theirs,
       const Batch<double>& target)
    : At(l,
         theirs,
         target,
         l.given_is_target ? target : Batch<double>(0, target.cols())) {}

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

void check_batch(const Learner& l, const char* targets, const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const HigTolerance tolerance(entry);
  const auto same = tolerance.array();
  At at(l, l.network.start(in), flat_columns(in.at(targets)));
  if (out.contains("loss")) {
    EXPECT_TRUE(same(at.loss.mean(), out.at("loss")));
  }
  if (out.contains("loss_sum")) {
    EXPECT_TRUE(same(at.loss.sum(), out.at("loss_sum")));
  }
  for (const char* state : {"y", "psi"}) {
    if (out.contains(state)) {
      EXPECT_TRUE(same(at.y, flat_columns(out.at(state))));
    }
  }
  const char* gradient = out.contains("grad_loss") ? "grad_loss" : "grad_mean";
  EXPECT_TRUE(same.summary(at.gradient(), out.at(gradient)));
  int updates = 0;
  for (const auto& [key, stored] : out.items()) {
    hig::Power power;
    if (!parse_power(key, power)) continue;
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

void check_sequence(const Learner& l,
                    const char* targets,
                    Index batch,
                    const Json& entry) {
  const Json &in = entry.at("input"), &out = entry.at("expected");
  const auto same = HigTolerance(entry).array();
  const Batch<double> all = flat_columns(in.at(targets));
  HalfInverseStep<double> step(
      {.power = {.kappa = in.value("kappa", -0.5), .tau = in.at("tau")},
       .rate = in.at("eta"),
       .numerics = {.tolerance = 1e-8}});
  Vector<double> theta = l.network.start(in);
  const bool before = out.contains("losses_before");
  const Vector<double> losses =
      flat(out.at(before ? "losses_before" : "losses"));
  const Index updates = losses.size() - (before ? 0 : 1);
  for (Index k = 0; k < updates; ++k) {
    const Batch<double> target =
        all.middleCols(k % (all.cols() / batch) * batch, batch);
    At at(l, theta, target);
    EXPECT_TRUE(same(at.loss.mean(), losses(k))) << "update " << k;
    at.update(step);
    theta = l.network.theirs(at.theta);
  }
  if (!before) {
    EXPECT_TRUE(same(At(l, theta, all).loss.mean(), losses(updates)));
  }
  EXPECT_TRUE(same.summary(theta, out.at("theta_final")));
}

}  // namespace physinv::test
