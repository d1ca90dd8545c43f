/// A damped pendulum that is seen eight times: how did it start, and how strong
/// is the damping?
///
///   theta'' = -w^2 sin(theta) - c theta',  y = theta at the times of sight
///
/// by the semi-implicit Euler method. Unknown x: angle and speed at the start,
/// damping c (3). Given: the frequency w (1). Observations y: angles (8). vjp:
/// exact, of the discrete steps.
///
/// A column of x that is not finite gives NaN in its own column only.
#pragma once

#include "suite/core/problem.h"
#include "suite/core/recipe.h"

namespace pendulum {

using namespace physinv;

struct PendulumOptions {
  double interval = 0.5;  ///< between sights, s
  Index substeps = 10;    ///< of an interval

  auto fields() const {
    return std::tuple{field("interval", interval), field("substeps", substeps)};
  }
};

template <class T>
class Pendulum final : public Problem<T>, public Vjp<T> {
 public:
  using Options = PendulumOptions;
  explicit Pendulum(const Options& options = {});

  Shape shape() const override { return {3, 8, 1}; }
  Vector<double> start() const override { return Eigen::Vector3d(0.5, 0, 0.1); }
  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override;
  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace&) const override;
  /// Keeps w^2, the damping and every angle and speed before its step.
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const override;
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override;
  /// A sine counts as 20.
  double operations() const override {
    return 27.0 * static_cast<double>(8 * options_.substeps);
  }

 private:
  T step_size() const {
    return static_cast<T>(options_.interval /
                          static_cast<double>(options_.substeps));
  }

  Options options_;
};

extern template class Pendulum<float>;
extern template class Pendulum<double>;

}  // namespace pendulum
