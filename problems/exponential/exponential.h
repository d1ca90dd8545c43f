/// The exponential of one number: gradients shrink with it, over five orders of
/// magnitude. (Scale-invariant physics training, App. C.2.)
///
///   y = exp(x),  x uniform in (-12, 0]
///
/// Unknown x (1). Given: nothing. Observation y (1). Loss: half the square.
/// vjp, Jacobian: exact, exp(x). Hessian: 2 exp(2 x) - y exp(x). invert: log y,
/// the only solution; a guess that y already is the exponential of stays, so
/// that nothing pushes it any more.
///
/// exp(x) is infinite beyond x = 88 in float, 709 in double. A column of x that
/// is not finite gives NaN or infinity in its own column only; y < 0 has no
/// inverse and gives NaN.
#pragma once

#include "suite/core/problem.h"
#include "suite/core/recipe.h"

namespace physinv {

struct ExponentialOptions {
  double lowest = -12;  ///< of the unknowns, the highest is 0

  auto fields() const { return std::tuple{field("lowest", lowest)}; }
};

template <class T>
class Exponential : public Problem<T>,
                    public Vjp<T>,
                    public Jvp<T>,
                    public PullbackTangent<T>,
                    public Jacobian<T>,
                    public Hessian<T>,
                    public Inverse<T> {
 public:
  using Options = ExponentialOptions;
  explicit Exponential(const Options& options = {});

  Shape shape() const override { return {1, 1, 0}; }
  Vector<double> start() const override { return Vector<double>::Zero(1); }

  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override;

  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override;
  /// Keeps exp(x).
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const override;
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override;
  void pushforward(const Tape& tape,
                   BatchIn<T> x_dot,
                   BatchOut<T> y_dot,
                   Workspace& work) const override;
  void pullback_tangent(const Tape& tape,
                        BatchIn<T> x_dot,
                        BatchIn<T> y_bar,
                        BatchIn<T> y_bar_dot,
                        BatchOut<T> x_bar_dot,
                        Workspace& work) const override;
  void jacobian(BatchIn<T> x,
                BatchIn<T> given,
                BatchOut<T> j,
                Workspace& work) const override;
  void hessian(BatchIn<T> x,
               BatchIn<T> given,
               BatchIn<T> target,
               BatchOut<T> h,
               Workspace& work) const override;
  void invert(BatchIn<T> y,
              BatchIn<T> given,
              BatchIn<T> x_guess,
              BatchOut<T> x,
              Workspace& work) const override;

  double operations() const override { return 20; }

  const Options& options() const { return options_; }

 private:
  Options options_;
};

extern template class Exponential<float>;
extern template class Exponential<double>;

}  // namespace physinv
