/// Two numbers, one of them scaled and perhaps squared. (Physics-based deep
/// learning, chapter "Scale-invariance and inversion".)
///
///   y = (x1, alpha x2^power),  power 1 or 2
///
/// Unknown x (2). Given: alpha (1), at first the listed ones, then uniform in
/// [1, 5). Observation y (2): 0, as the chapter's. Loss: the square |y - y*|^2
/// or half of it.
///
/// vjp, Jacobian, Hessian: exact. invert: the root nearest to the guess, whose
/// sign decides, that of a zero too; a negative square has none, and 0 comes
/// nearest. Closed steps: exact for every x2, with power 2 at x2 = 0 too if
/// y* = 0: -x2 / 3 (Newton) and -x2 / 2 (inverse gradient).
///
/// A column of x that is not finite gives NaN in its own column only.
#pragma once

#include <array>
#include <vector>

#include "suite/core/closed_steps.h"
#include "suite/core/problem.h"
#include "suite/core/recipe.h"

namespace physinv {

struct ScalingOptions {
  std::vector<double> scales = {1};  ///< alpha of the first problems, not 0
  int power = 1;                     ///< of x2
  bool half = false;                 ///< loss: half the square
  std::array<double, 2> start = {0.5, 0.85};

  auto fields() const {
    return std::tuple{field("scales", scales),
                      field("power", power),
                      field("half", half),
                      field("start", start)};
  }
};

template <class T>
class Scaling : public Problem<T>,
                public Vjp<T>,
                public Jacobian<T>,
                public Hessian<T>,
                public Inverse<T>,
                public ClosedSteps<T> {
 public:
  using Options = ScalingOptions;
  explicit Scaling(const Options& options = {});

  Shape shape() const override { return {2, 2, 1}; }
  Vector<double> start() const override;

  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override;
  /// x uniform in [0.5, 3.5)^2.
  Samples<double> sample_labelled(Index first,
                                  Index count,
                                  const Rng& rng) const override;

  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override;
  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override;
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override;
  /// Keeps the slopes d y / d x.
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

  void newton_step(BatchIn<T> x,
                   BatchIn<T> given,
                   BatchIn<T> target,
                   BatchOut<T> dx) const override;
  void inverse_gradient_step(BatchIn<T> x,
                             BatchIn<T> given,
                             BatchIn<T> target,
                             BatchOut<T> dx) const override;

  double operations() const override { return 2; }

  const Options& options() const { return options_; }

 private:
  /// y of column i and d y / d x, which is diagonal.
  struct Point {
    T y[2], slope[2];
  };
  Point at(BatchIn<T> x, BatchIn<T> given, Index i) const;
  Samples<double> draw(Index first,
                       Index count,
                       const Rng& rng,
                       bool labelled) const;
  T scale() const { return T(options_.half ? 1 : 2); }

  Options options_;
};

extern template class Scaling<float>;
extern template class Scaling<double>;

}  // namespace physinv
