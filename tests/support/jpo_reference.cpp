#include "tests/support/jpo_reference.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "optimizers/jpo.h"
#include "optimizers/steps/clip_percentile.h"
#include "tests/support/formula_weights.h"
#include "tests/support/listed.h"
#include "tests/support/quadratic.h"

namespace physinv::test {

Notes* notes = nullptr;

namespace {

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
  void initialize(const Rng& rng,
                  VectorOut<T> parameters,
                  VectorOut<T> state) const override {
    net_->initialize(rng, parameters, state);
    formula_weights<T>(tensors(),
                       numbers_in_order(tensors().size()),
                       shift_,
                       last_,
                       parameters);
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

/// Writes down where it was linearized, and the gradients there.
template <class T>
class Noted final : public Listed<T> {
 public:
  using Listed<T>::Listed;

  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    Listed<T>::linearize(at, y, tape);
    notes->xi.emplace_back(at.x.template cast<double>());
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    Listed<T>::pullback(tape, y_bar, x_bar, work);
    notes->gradients.emplace_back(x_bar.template cast<double>());
  }
};

}  // namespace

void expect_jpo(const std::string& id,
                const Json& entry,
                JpoEntry about,
                const ProblemRecipe& problem,
                Samples<double> samples,
                Precision precision) {
  Notes seen;
  samples.x.resize(0, samples.count());
  notes = &seen;
  about.rate = setting(entry, "lr", "lr", about.rate);
  about.output_scale =
      setting(entry, "output_scale", "= 1 \\+", about.output_scale);
  const double shift = formula_shift(id, entry);
  const double last = setting(entry,
                              "last_matrix",
                              "last weight matrix (?:multiplied by|times)",
                              about.last_matrix);
  const NetworkRecipe net{
      .description = "noting",
      .make_float =
          [=](Index in, Index out) {
            return std::make_unique<Noting<float>>(
                about.network.make<float>(in, out), shift, last);
          },
      .make_double =
          [=](Index in, Index out) {
            return std::make_unique<Noting<double>>(
                about.network.make<double>(in, out), shift, last);
          }};
  const auto jpo = jpo_fit({.step = AdamOptions{.rate = about.rate}});
  const Json steps = entry.at("steps");
  const auto count = static_cast<Index>(steps.size());
  ASSERT_GE(count, 2);  // a step or more, and what they led to
  StageBench bench(*jpo,
                   samples.count(),
                   count,
                   with_samples<Noted>(problem, samples),
                   {.predictor = {about.inputs, net},
                    .surrogate = {},
                    .output_scale = about.output_scale});
  const Shape shape = problem.make<double>()->shape();
  const Index in = input_rows(about.inputs, shape), out = shape.unknowns;
  const auto plain = about.network.make<double>(in, out);
  expect_parameters(entry, plain->parameter_count());
  bench.run(nullptr, precision);
  const Batch<double> losses = bench.traced<double>(samples.count());

  const bool single = precision == Precision::f32;
  const Comparator exact = EntryTolerance(entry).array();
  const auto limit = [&](double in_float) {
    return single ? Comparator(in_float, 0) : exact;
  };
  const Comparator same = limit(about.single.output),
                   same_loss = limit(about.single.loss),
                   follows = limit(about.single.gradient);
  const auto& tensors = plain->tensors();
  const auto tensor_count = static_cast<Index>(tensors.size());
  for (Index k = 0; k < (single ? 1 : count); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Json step = steps.at(at);
    SCOPED_TRACE("step " + step.at("step").dump());
    EXPECT_TRUE(same(seen.outputs.at(at + 1), columns(step.at("net_output"))));
    EXPECT_TRUE(same(seen.xi.at(at + 1), columns(step.at("xi"))));
    EXPECT_TRUE(same_loss(losses.col(k), vector(step.at("loss"))));
    if (!step.contains("grad_xi")) {
      EXPECT_EQ(k + 1, count) << "only the last state has no gradient";
      continue;
    }
    const Batch<double>& g = seen.gradients.at(at + 1);
    EXPECT_TRUE(follows(g, columns(step.at("grad_xi"))));
    EXPECT_TRUE(follows(g.colwise().stableNorm().transpose(),
                        vector(step.at("grad_norm"))));
    Batch<double> again = g;
    EXPECT_TRUE(follows(ClipPercentile(0.9).operator()<double>(again),
                        number(step.at("clip_threshold"))));
    EXPECT_TRUE(
        follows(seen.clipped.at(at + 1),
                about.output_scale *
                    columns(step.at("grad_clipped"), out, samples.count())));

    const Vector<double>& w = seen.weights.at(at + 1);
    const Json first = step.at("weight_grad_first_entries");
    const Vector<double> stored_norms =
        vector(step.at("weight_grad_norm_per_tensor"), tensor_count);
    const double largest = stored_norms.maxCoeff();
    Vector<double> norms(static_cast<Index>(tensors.size()));
    for (std::size_t t = 0; t < tensors.size(); ++t) {
      const auto part = w.segment(tensors[t].offset, tensors[t].size);
      norms(static_cast<Index>(t)) = part.stableNorm();
      if (stored_norms(static_cast<Index>(t)) <= 1e-8 * largest) {
        // Exactly zero, as of a bias in front of a normalisation; what is
        // stored is rounding noise.
        EXPECT_LE(part.stableNorm(), (single ? 1e-6 : 1e-8) * largest)
            << tensors[t].name;
        continue;
      }
      const Vector<double> stored = vector(first.at(t));
      ASSERT_LE(stored.size(), part.size());
      // Relative to the whole tensor, of which these are the first entries.
      EXPECT_TRUE(Comparator(0, follows.rtol() * part.cwiseAbs().maxCoeff())(
          part.head(stored.size()), stored))
          << tensors[t].name;
    }
    EXPECT_TRUE(follows(norms, stored_norms));
  }
}

}  // namespace physinv::test
