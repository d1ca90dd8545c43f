/// Entries `jpo_mlp` and `jpo_g2s` of the reference files through the stage
/// itself: a network and a problem that write down what passes through them.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "suite/core/method.h"
#include "suite/core/problem.h"
#include "suite/core/recipe.h"
#include "tests/support/reference.h"

namespace physinv::test {

/// What one run passed around; the first pass of each is the warm-up.
struct Notes {
  std::vector<Batch<double>> outputs, clipped, xi, gradients;
  std::vector<Vector<double>> weights;
};
extern Notes* notes;

/// P with given samples.
template <template <class> class P, class T>
class Fixed final : public Problem<T>, public Vjp<T> {
 public:
  Fixed(Samples<double> samples, const typename P<T>::Options& options)
      : inner_(options), samples_(std::move(samples)) {}

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

/// What the specification says about the network and its training; an entry
/// may state other rates and factors.
struct JpoEntry {
  std::vector<Field> inputs;
  NetworkRecipe network;
  double rate;
  double last_matrix = 1;   ///< factor of its formula weights
  double output_scale = 1;  ///< estimates = start + scale * output
  /// In float, relative to the largest entry (M9 of the methods).
  struct {
    double output = 1e-4, loss = 1e-4, gradient = 1e-4;
  } single = {};
};

/// The stage on such problems, against every step of the entry; in float,
/// against the first.
void expect_jpo(const std::string& id,
                const Json& entry,
                JpoEntry about,
                const ProblemRecipe& fixed,
                Index problems,
                Precision precision);

/// The same on problems P with these observations.
template <template <class> class P>
void expect_jpo(const std::string& id,
                const Json& entry,
                const JpoEntry& about,
                const Samples<double>& samples,
                Precision precision,
                const typename P<double>::Options& options = {}) {
  const ProblemRecipe fixed{
      .name = "fixed",
      .options = {},
      .provided = Needs::forward | Needs::vjp,
      .make_float =
          [=] { return std::make_unique<Fixed<P, float>>(samples, options); },
      .make_double =
          [=] { return std::make_unique<Fixed<P, double>>(samples, options); }};
  expect_jpo(id, entry, about, fixed, samples.count(), precision);
}

}  // namespace physinv::test
