#include "problems/scaling/scaling.h"

#include <cmath>

#include "suite/core/check.h"
#include "suite/core/closed_steps.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

enum Slot : std::size_t { kSlopes };

}  // namespace

namespace {

template <class T>
class Scaling final : public Problem<T>,
                      public Vjp<T>,
                      public Jacobian<T>,
                      public Hessian<T>,
                      public Inverse<T>,
                      public ClosedSteps<T> {
 public:
  explicit Scaling(const ScalingOptions& options) : options_(options) {
    SUITE_CHECK(options.power == 1 || options.power == 2,
                "power must be 1 or 2");
    check_numbers<T>("scales", options.scales);
    for (const double alpha : options.scales)
      SUITE_CHECK(alpha != 0, "a scale must not be 0");
    check_numbers<T>(
        {{"start", options.start[0]}, {"start", options.start[1]}});
  }

  Shape shape() const override { return {2, 2, 1}; }
  Vector<double> start() const override {
    return Eigen::Vector2d(options_.start[0], options_.start[1]);
  }

  /// x = 0 of y = 0, of labelled samples uniform in [0.5, 3.5)^2.
  void draw(Stream& stream, SampleOut& sample) const override {
    const auto k = static_cast<std::size_t>(sample.index);
    const double drawn = stream.uniform(1, 5);
    const auto& listed = options_.scales;
    sample.given(0) = k < listed.size() ? listed[k] : drawn;
    if (!sample.labelled) return;
    for (Index j = 0; j < 2; ++j) sample.x(j) = stream.uniform(0.5, 3.5);
  }
  Drawn drawn() const override { return Drawn::both; }

  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    for (Index i = 0; i < y.cols(); ++i) {
      const Value p = value(at, i);
      y.col(i) << p.y[0], p.y[1];
    }
  }
  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override {
    Problem<T>::loss(y, target, loss);
    loss *= static_cast<double>(scale());
  }
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override {
    for_numbers<T>(
        y, target, y_bar, [c = scale()](T a, T b) { return c * (a - b); });
  }
  /// Keeps the slopes d y / d x.
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    auto slopes = tape.slot<T>(kSlopes, 2, y.cols());
    for (Index i = 0; i < y.cols(); ++i) {
      const Value p = value(at, i);
      y.col(i) << p.y[0], p.y[1];
      slopes.col(i) << p.slope[0], p.slope[1];
    }
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    const auto slopes = tape.view<T>(kSlopes);
    for_numbers<T>(slopes, y_bar, x_bar, [](T a, T b) { return a * b; });
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace&) const override {
    for (Index i = 0; i < j.cols(); ++i) {
      const Value p = value(at, i);
      j.col(i) << p.slope[0], 0, 0, p.slope[1];
    }
  }
  void hessian(Point<T> at,
               BatchIn<T> target,
               BatchOut<T> h,
               Workspace&) const override {
    for (Index i = 0; i < h.cols(); ++i) {
      const Value p = value(at, i);
      const T bend = options_.power == 2 ? 2 * at.given(0, i) : T(0);
      const T second =
          std::fma(p.slope[1], p.slope[1], (p.y[1] - target(1, i)) * bend);
      h.col(i) << scale() * (p.slope[0] * p.slope[0]), 0, 0, scale() * second;
    }
  }
  void invert(Point<T> near,
              BatchIn<T> y,
              BatchOut<T> x,
              Workspace&) const override {
    for (Index i = 0; i < x.cols(); ++i) {
      const T b = y(1, i) / near.given(0, i);
      const T root = b < 0 ? T(0) : std::sqrt(b);
      x.col(i) << y(0, i),
          options_.power == 2 ? std::copysign(root, near.x(1, i)) : b;
    }
  }

  // Neither step divides by what may be a square that underflowed.
  void newton_step(Point<T> at,
                   BatchIn<T> target,
                   BatchOut<T> dx) const override {
    for (Index i = 0; i < dx.cols(); ++i) {
      const Value p = value(at, i);
      const T b = at.x(1, i), goal = target(1, i), rest = goal - p.y[1];
      T step = rest / at.given(0, i);
      if (options_.power == 2)
        step = goal == 0 ? -b / 3 : b * (rest / std::fma(T(3), p.y[1], -goal));
      dx.col(i) << target(0, i) - p.y[0], step;
    }
  }
  void inverse_gradient_step(Point<T> at,
                             BatchIn<T> target,
                             BatchOut<T> dx) const override {
    for (Index i = 0; i < dx.cols(); ++i) {
      const Value p = value(at, i);
      const T b = at.x(1, i), goal = target(1, i);
      T step = (goal - p.y[1]) / p.slope[1];
      if (options_.power == 2 && goal == 0) step = -b / 2;
      dx.col(i) << target(0, i) - p.y[0], step;
    }
  }

  double operations() const override { return 2; }

 private:
  /// y of column i and d y / d x, which is diagonal.
  struct Value {
    T y[2], slope[2];
  };
  Value value(const Point<T>& at, Index i) const {
    const T a = at.x(0, i), b = at.x(1, i), alpha = at.given(0, i);
    const T zero = (a - a) + (b - b);  // NaN where x is not finite
    if (options_.power == 1)
      return {{a + zero, alpha * b + zero}, {1 + zero, alpha + zero}};
    return {{a + zero, alpha * (b * b) + zero},
            {1 + zero, 2 * alpha * b + zero}};
  }
  T scale() const { return T(options_.half ? 1 : 2); }

  ScalingOptions options_;
};

}  // namespace

ProblemRecipe problems::scaling(const ScalingOptions& options) {
  return problem<Scaling>(
      "scaling",
      options,
      {.unknowns = {"x1, x2"}, .observations = {"y1, y2"}, .given = {"alpha"}});
}

}  // namespace physinv
