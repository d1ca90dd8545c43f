/// Entries `jpo_mlp` of the reference files through the stage itself: a network
/// and a problem that write down what passes through them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "optimizers/jpo.h"
#include "optimizers/steps/clip_percentile.h"
#include "suite/nn/mlp.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {

/// What one run passed around; the first pass of each is the warm-up.
struct Notes {
  std::vector<Batch<double>> outputs, clipped, xi, gradients;
  std::vector<Vector<double>> weights;
};
inline Notes* notes = nullptr;

/// A network with formula weights, the last matrix times `last`.
template <class T>
class Noting final : public Network<T> {
 public:
  Noting(std::unique_ptr<Network<T>> net, double shift, double last)
      : net_(std::move(net)), shift_(shift), last_(last) {}

  Index inputs() const override { return net_->inputs(); }
  Index outputs() const override { return net_->outputs(); }
  Index parameter_count() const override { return net_->parameter_count(); }
  Index state_count() const override { return net_->state_count(); }
  const std::vector<TensorInfo>& tensors() const override {
    return net_->tensors();
  }
  void initialize(const Rng&,
                  VectorOut<T> parameters,
                  VectorOut<T>) const override {
    const auto& all = tensors();
    for (std::size_t t = 0; t < all.size(); ++t) {
      const double last = t + 2 == all.size() ? last_ : 1.0;
      const double ft = static_cast<double>(t);
      for (Index k = 0; k < all[t].size; ++k) {
        const double fk = static_cast<double>(k);
        const double value =
            all[t].kind == 'b'
                ? 0.05 * std::cos(0.9 * fk + 0.4 * ft + shift_)
                : last * std::sqrt(3.0 / static_cast<double>(all[t].fan_in)) *
                      std::sin(0.7 * fk + 1.3 * ft + 0.5 + shift_);
        parameters(all[t].offset + k) = static_cast<T>(value);
      }
    }
  }
  void forward(VectorIn<T> parameters,
               VectorIn<T> state,
               BatchIn<T> in,
               BatchOut<T> out,
               Tape& tape,
               Workspace& work,
               Pass pass) const override {
    net_->forward(parameters, state, in, out, tape, work, pass);
    notes->outputs.emplace_back(out.template cast<double>());
  }
  void backward(VectorIn<T> parameters,
                const Tape& tape,
                BatchIn<T> out_bar,
                VectorOut<T>* parameters_bar,
                BatchOut<T>* in_bar,
                Workspace& work) const override {
    net_->backward(parameters, tape, out_bar, parameters_bar, in_bar, work);
    notes->clipped.emplace_back(out_bar.template cast<double>());
    notes->weights.emplace_back(parameters_bar->template cast<double>());
  }
  void update_state(const Tape& tape, VectorOut<T> state) const override {
    net_->update_state(tape, state);
  }
  double operations() const override { return net_->operations(); }

 private:
  std::unique_ptr<Network<T>> net_;
  double shift_, last_;
};

/// P with given samples.
template <template <class> class P, class T>
class Fixed final : public Problem<T>, public Vjp<T> {
 public:
  explicit Fixed(Samples<double> samples) : samples_(std::move(samples)) {}

  Shape shape() const override { return inner_.shape(); }
  Vector<double> start() const override { return inner_.start(); }
  Samples<double> sample(Index, Index count, const Rng&) const override {
    return {{}, samples_.y.leftCols(count), samples_.given.leftCols(count)};
  }
  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override {
    inner_.forward(x, given, y, work);
  }
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const override {
    inner_.linearize(x, given, y, tape);
    notes->xi.emplace_back(x.template cast<double>());
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    inner_.pullback(tape, y_bar, x_bar, work);
    notes->gradients.emplace_back(x_bar.template cast<double>());
  }
  double operations() const override { return inner_.operations(); }

 private:
  P<T> inner_;
  Samples<double> samples_;
};

/// What the file says about the network and its training.
struct JpoEntry {
  std::vector<Field> inputs;
  nn::MlpOptions network;
  Index parameters;
  double rate;
  double last_matrix = 1;  ///< factor of its formula weights
};

/// The stage on problems P with these observations, against every step of the
/// entry; in float, against the first.
template <template <class> class P>
void expect_jpo(const Json& entry,
                const JpoEntry& about,
                const Samples<double>& samples,
                Precision precision) {
  Notes seen;
  notes = &seen;
  const double shift = entry.value("shift", 0.0);
  const ProblemRecipe fixed{
      .name = "fixed",
      .options = {},
      .provided = Needs::forward | Needs::vjp,
      .make_float = [=] { return std::make_unique<Fixed<P, float>>(samples); },
      .make_double =
          [=] { return std::make_unique<Fixed<P, double>>(samples); }};
  const double last = about.last_matrix;
  const auto mlp = nn::mlp(about.network);
  const NetworkRecipe net{.description = "noting",
                          .make_float =
                              [=](Index in, Index out) {
                                return std::make_unique<Noting<float>>(
                                    mlp.make<float>(in, out), shift, last);
                              },
                          .make_double =
                              [=](Index in, Index out) {
                                return std::make_unique<Noting<double>>(
                                    mlp.make<double>(in, out), shift, last);
                              }};
  const auto jpo = jpo_fit({.step = AdamOptions{.rate = about.rate}});
  const Json& steps = entry.at("steps");
  const auto count = static_cast<Index>(steps.size());
  ASSERT_EQ(count, 4);  // 3 steps and what they led to
  StageBench bench(*jpo,
                   samples.count(),
                   count,
                   fixed,
                   {.predictor = {about.inputs, net}, .surrogate = {}});
  const Shape shape = P<double>().shape();
  const Index in = input_rows(about.inputs, shape), out = shape.unknowns;
  ASSERT_EQ(mlp.make<double>(in, out)->parameter_count(), about.parameters);
  bench.run(nullptr, precision);
  const Batch<double> losses = bench.traced<double>(samples.count());

  const bool single = precision == Precision::f32;
  const Comparator same =
      single ? Comparator(1e-4, 0) : EntryTolerance(entry).array();
  const auto tensors = mlp.make<double>(in, out)->tensors();
  for (Index k = 0; k < (single ? 1 : count); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Json& step = steps.at(at);
    SCOPED_TRACE("step " + step.at("step").dump());
    EXPECT_TRUE(same(seen.outputs.at(at + 1), columns(step.at("net_output"))));
    EXPECT_TRUE(same(seen.xi.at(at + 1), columns(step.at("xi"))));
    EXPECT_TRUE(same(losses.col(k), vector(step.at("loss"))));
    if (!step.contains("grad_xi")) {
      EXPECT_EQ(k + 1, count) << "only the last state has no gradient";
      continue;
    }
    const Batch<double>& g = seen.gradients.at(at + 1);
    EXPECT_TRUE(same(g, columns(step.at("grad_xi"))));
    EXPECT_TRUE(
        same(g.colwise().norm().transpose(), vector(step.at("grad_norm"))));
    Batch<double> again = g;
    EXPECT_TRUE(same(ClipPercentile(0.9).operator()<double>(again),
                     step.at("clip_threshold").get<double>()));
    EXPECT_TRUE(
        same(seen.clipped.at(at + 1), columns(step.at("grad_clipped"))));

    const Vector<double>& w = seen.weights.at(at + 1);
    const Json& first = step.at("weight_grad_first_entries");
    Vector<double> norms(static_cast<Index>(tensors.size()));
    for (std::size_t t = 0; t < tensors.size(); ++t) {
      const auto part = w.segment(tensors[t].offset, tensors[t].size);
      norms(static_cast<Index>(t)) = part.norm();
      const Vector<double> stored = vector(first.at(t));
      // Relative to the whole tensor, of which these are the first entries.
      EXPECT_TRUE(Comparator(0, same.rtol() * part.cwiseAbs().maxCoeff())(
          part.head(stored.size()), stored))
          << tensors[t].name;
    }
    EXPECT_TRUE(same(norms, vector(step.at("weight_grad_norm_per_tensor"))));
  }
}

}  // namespace physinv::test
