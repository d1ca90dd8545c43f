/// Two coupled nonlinear oscillators: which control brings the pair back to
/// where it started? (Half-inverse gradients, Sec. 3.1, App. B.2 and C,
/// Figs. 2, 5, 6, 12, 13; the form is that of the authors' code.)
///
///   x1' = p1,  p1' = -x1 + g (x2 - x1)^3
///   x2' = p2,  p2' = -x2 - g (x2 - x1)^3 + C u_n
///
/// Classical Runge-Kutta of order 4, u_n constant during step n. One step's
/// derivative needs of the trajectory only w_i = 3 g (x2 - x1)^2 at its four
/// stages, so these are what a linearization keeps. Cotangents run backwards
/// through the stages: one row for a gradient, four for the Jacobian.
///
/// Unknown x: the controls u_0 .. u_{steps-1}. Given: the state (x1, x2, p1,
/// p2) at the start. Observation y: the state at the end; wanted is the given
/// state. Loss: sum of squares, no 1/2. vjp, Jacobian: exact.
///
/// Controls beyond the stability of the integrator overflow and give
/// non-finite numbers in their own column only.
#pragma once

#include <array>

#include "suite/core/problem.h"
#include "suite/core/recipe.h"

namespace physinv {

struct OscillatorsOptions {
  Index steps = 96;
  double dt = 0.125;      ///< time step
  double coupling = 1.0;  ///< g; 4 reads the paper's Hamiltonian literally
  double control = 3.0;   ///< C
  /// Controls of labelled samples are N(0, deviation^2).
  double deviation = 0.3;

  auto fields() const {
    return std::tuple{field("steps", steps),
                      field("dt", dt),
                      field("coupling", coupling),
                      field("control", control),
                      field("deviation", deviation)};
  }
};

/// One time step: y = state after it, a = dy / d state (4 x 4), b = dy / du.
struct OscillatorsStep {
  std::array<double, 4> y{};
  std::array<std::array<double, 4>, 4> a{};  ///< a[row][column]
  std::array<double, 4> b{};
};

/// Through the same kernels as `Oscillators<T>`.
template <class T>
OscillatorsStep oscillators_step(const std::array<double, 4>& state,
                                 double u,
                                 const OscillatorsOptions& options = {});

template <class T>
class Oscillators final : public Problem<T>, public Vjp<T>, public Jacobian<T> {
 public:
  using Options = OscillatorsOptions;
  explicit Oscillators(const Options& options = {});

  Shape shape() const override { return {options_.steps, 4, 4}; }
  /// No control.
  Vector<double> start() const override;

  /// States uniform in [0, 1)^4, observed where they started; no truth.
  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override;
  /// The same states under random controls, and where these lead.
  Samples<double> sample_labelled(Index first,
                                  Index count,
                                  const Rng& rng) const override;

  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override;
  /// Keeps four numbers per step and sample.
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

  /// |y - target|^2
  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override;
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override;

  double operations() const override {
    return 80.0 * static_cast<double>(options_.steps);
  }

  const Options& options() const { return options_; }

 private:
  Options options_;
};

extern template class Oscillators<float>;
extern template class Oscillators<double>;

}  // namespace physinv
