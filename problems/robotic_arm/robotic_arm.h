/// Robotic arm: which base height and joint angles bring the tip to a given
/// point? (Joint parameter optimization, App. D.5, Fig. 25; the arm is that of
/// the neural-adjoint paper, Ren, Padilla and Malof 2020.)
///
/// The base slides on a vertical rail, three links l_k turn in the plane. Each
/// angle is relative, and both earlier ones are subtracted from the last:
///
///   phi_1 = x_2,  phi_2 = x_3 - x_2,  phi_3 = x_4 - x_3 - x_2
///   y = (sum_k l_k cos phi_k,  x_1 + sum_k l_k sin phi_k)
///
/// With d_k = dy / dphi_k = l_k (-sin phi_k, cos phi_k) the columns of the
/// Jacobian are (0, 1), d_1 - d_2 - d_3, d_2 - d_3, d_3: three sines and
/// cosines give y and all derivatives.
///
/// Unknown x: base height, three angles (4). Given: nothing. Observation y:
/// the tip (2). Two equations for four unknowns: a solution is judged by its
/// loss. vjp, Jacobian: exact. Stretched poses are singular; at x = 0 no
/// unknown moves the tip sideways.
///
/// A column of x that is not finite gives NaN in its own column only.
#pragma once

#include <array>

#include "suite/core/problem.h"
#include "suite/core/recipe.h"

namespace physinv {

struct RoboticArmOptions {
  std::array<double, 3> links = {0.5, 0.5, 1.0};
  /// Prior of the unknowns, normal; its mean is the first guess.
  std::array<double, 4> mean = {0.0, 0.0, 0.0, 0.0};
  std::array<double, 4> deviation = {0.25, 0.5, 0.5, 0.5};

  auto fields() const {
    return std::tuple{field("links", links),
                      field("mean", mean),
                      field("deviation", deviation)};
  }
};

/// Base, the two joints between the links, and the tip. For plots and checks.
std::array<std::array<double, 2>, 4> arm_joints(
    const std::array<double, 4>& x, const RoboticArmOptions& options = {});

template <class T>
class RoboticArm final : public Problem<T>, public Vjp<T>, public Jacobian<T> {
 public:
  using Options = RoboticArmOptions;
  explicit RoboticArm(const Options& options = {});

  Shape shape() const override { return {4, 2, 0}; }
  Vector<double> start() const override;

  /// x ~ N(mean, deviation^2), y = F(x) in double: every tip is in reach.
  /// Labelled samples come from the same distribution.
  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override;

  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override;
  /// Keeps d_1, d_2, d_3 per sample.
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const override;
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override;
  /// Rows of j: dy0/dx0, dy1/dx0, dy0/dx1, ...
  void jacobian(BatchIn<T> x,
                BatchIn<T> given,
                BatchOut<T> j,
                Workspace& work) const override;

  /// A sine with its cosine counts as 20.
  double operations() const override { return 75; }

  const Options& options() const { return options_; }

 private:
  Options options_;
};

extern template class RoboticArm<float>;
extern template class RoboticArm<double>;

}  // namespace physinv
