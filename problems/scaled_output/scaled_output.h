/// Two numbers, of which the second is seen through a small factor: the
/// simplest physics that spoils the conditioning of a fit. (Half-inverse
/// gradients, Secs. 2.1, 2.2, App. B.1, Fig. 1.)
///
///   z = (x_1, gamma x_2),  wanted z = (sin 6 t, cos 9 t)
///
/// Unknown x: the output of a network (2). Given: the point t in [-1, 1]; it
/// does not enter z. Observation: z (2). Loss: half the sum of squares. vjp,
/// Jacobian: exact and constant, diag(1, gamma).
///
/// What is not finite stays in its own column.
#pragma once

#include "suite/core/linear_problem.h"
#include "suite/core/recipe.h"

namespace physinv {

struct ScaledOutputOptions {
  double gamma = 0.01;  ///< 1 is well, 0.01 ill conditioned

  auto fields() const { return std::tuple{field("gamma", gamma)}; }
};

template <class T>
class ScaledOutput final : public LinearProblem<T>, public Jacobian<T> {
 public:
  using Options = ScaledOutputOptions;
  explicit ScaledOutput(const Options& options = {});

  Shape shape() const override { return {2, 2, 1}; }
  Vector<double> start() const override { return Vector<double>::Zero(2); }

  /// t uniform in [-1, 1), y = (sin 6 t, cos 9 t), x = (y_1, y_2 / gamma).
  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override;
  /// The same with y = F(x) as rounded.
  Samples<double> sample_labelled(Index first,
                                  Index count,
                                  const Rng& rng) const override;

  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override;
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const override;
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override;
  void jacobian(BatchIn<T> x,
                BatchIn<T> given,
                BatchOut<T> j,
                Workspace& work) const override;

  double operations() const override { return 1; }

  const Options& options() const { return options_; }

 private:
  Options options_;
};

extern template class ScaledOutput<float>;
extern template class ScaledOutput<double>;

}  // namespace physinv
