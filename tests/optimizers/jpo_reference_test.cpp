// Entry jpo_mlp of jpo-billiards through the stage itself: a network and a
// problem that write down what passes through them. And: no entry of the file
// is without a test.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "optimizers/jpo.h"
#include "optimizers/steps/clip_percentile.h"
#include "problems/billiards/billiards.h"
#include "suite/nn/mlp.h"
#include "tests/support/quadratic.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

/// What one run passed around; the first pass of each is the warm-up.
struct Notes {
  std::vector<Batch<double>> outputs, clipped, xi, gradients;
  std::vector<Vector<double>> weights;
};
Notes* notes = nullptr;

/// A network with formula weights.
template <class T>
class Noting final : public Network<T> {
 public:
  Noting(std::unique_ptr<Network<T>> net, double shift)
      : net_(std::move(net)), shift_(shift) {}

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
      const double last = t + 2 == all.size() ? 0.05 : 1.0;
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
  double shift_;
};

/// Billiards with given balls.
template <class T>
class Table final : public Problem<T>, public Vjp<T> {
 public:
  explicit Table(Batch<double> balls) : balls_(std::move(balls)) {}

  Shape shape() const override { return game_.shape(); }
  Vector<double> start() const override { return game_.start(); }
  Samples<double> sample(Index, Index count, const Rng&) const override {
    const auto& target = game_.options().target;
    Samples<double> s{{}, Batch<double>(2, count), balls_.leftCols(count)};
    s.y.colwise() = Eigen::Vector2d(target[0], target[1]);
    return s;
  }
  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override {
    game_.forward(x, given, y, work);
  }
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const override {
    game_.linearize(x, given, y, tape);
    notes->xi.emplace_back(x.template cast<double>());
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    game_.pullback(tape, y_bar, x_bar, work);
    notes->gradients.emplace_back(x_bar.template cast<double>());
  }
  double operations() const override { return game_.operations(); }

 private:
  Billiards<T> game_;
  Batch<double> balls_;
};

void run_entry(const Json& entry, Precision precision) {
  Notes seen;
  notes = &seen;
  const Batch<double> balls = columns(entry.at("balls"));
  const double shift = entry.value("shift", 0.0);
  const ProblemRecipe table{
      .name = "table",
      .options = {},
      .provided = Needs::forward | Needs::vjp,
      .make_float = [=] { return std::make_unique<Table<float>>(balls); },
      .make_double = [=] { return std::make_unique<Table<double>>(balls); }};
  const auto mlp = nn::mlp({.hidden = {128, 128, 128}, .frequencies = 4});
  const NetworkRecipe net{.description = "noting",
                          .make_float =
                              [=](Index in, Index out) {
                                return std::make_unique<Noting<float>>(
                                    mlp.make<float>(in, out), shift);
                              },
                          .make_double =
                              [=](Index in, Index out) {
                                return std::make_unique<Noting<double>>(
                                    mlp.make<double>(in, out), shift);
                              }};
  const auto jpo = jpo_fit({.step = {.rate = 1e-4}});
  const Json& steps = entry.at("steps");
  const auto count = static_cast<Index>(steps.size());
  StageBench bench(*jpo,
                   balls.cols(),
                   count,
                   table,
                   {.predictor = {{Field::given, Field::observations}, net},
                    .surrogate = {}});
  ASSERT_EQ(mlp.make<double>(4, 2)->parameter_count(), 37506);
  bench.run(nullptr, precision);
  const Batch<double> losses = bench.traced<double>(balls.cols());

  const bool single = precision == Precision::f32;
  const Comparator same =
      single ? Comparator(1e-4, 0) : EntryTolerance(entry).array();
  const auto tensors = mlp.make<double>(4, 2)->tensors();
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

TEST(JpoReference, Double) {
  const auto entries = reference_entries("jpo-billiards", "jpo_mlp");
  ASSERT_FALSE(entries.empty());
  for (const Json& e : entries) {
    ASSERT_EQ(e.at("steps").size(), 4U);  // 3 steps and what they led to
    run_entry(e, Precision::f64);
  }
}

TEST(JpoReference, FirstStepInFloat) {
  for (const Json& e : reference_entries("jpo-billiards", "jpo_mlp"))
    run_entry(e, Precision::f32);
}

TEST(JpoReference, EveryEntryOfTheFileHasATest) {
  expect_known_entries("jpo-billiards",
                       {"clip_percentile_90",
                        "boundary_loss",
                        "bfgs_test_functions",
                        "simulate",
                        "bfgs",
                        "gd_adaptive",
                        "encoding",
                        "jpo_mlp"});
}

}  // namespace
}  // namespace physinv::test
