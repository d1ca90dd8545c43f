#include "problems/exponential/exponential.h"

#include <cmath>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

enum Slot : std::size_t { kExponential };

template <class T>
class Exponential final : public Problem<T>,
                          public Vjp<T>,
                          public Jvp<T>,
                          public PullbackTangent<T>,
                          public Jacobian<T>,
                          public Hessian<T>,
                          public Inverse<T> {
 public:
  explicit Exponential(const ExponentialOptions& o) : lowest_(o.lowest) {
    check_numbers<T>({{"lowest", o.lowest}});
    SUITE_CHECK(o.lowest < 0, "lowest must be negative");
  }

  Shape shape() const override { return {1, 1, 0}; }
  Vector<double> start() const override { return Vector<double>::Zero(1); }
  double operations() const override { return 20; }

  void draw(Stream& stream, SampleOut& sample) const override {
    sample.x(0) = lowest_ * stream.uniform(0, 1);
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace& /*work*/) const override {
    for (Index i = 0; i < y.cols(); ++i) y(0, i) = math::exp(at.x(0, i));
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    Workspace none;
    forward(at, y, none);
    tape.slot<T>(kExponential, 1, y.cols()) = y;
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& /*work*/) const override {
    x_bar = tape.view<T>(kExponential).cwiseProduct(y_bar);
  }
  void pushforward(const Tape& tape,
                   BatchIn<T> x_dot,
                   BatchOut<T> y_dot,
                   Workspace& work) const override {
    pullback(tape, x_dot, y_dot, work);
  }
  void pullback_tangent(const Tape& tape,
                        Directions<T> along,
                        BatchOut<T> x_bar_dot,
                        Workspace& /*work*/) const override {
    const auto& [x_dot, y_bar, y_bar_dot] = along;
    const auto y = tape.view<T>(kExponential);
    for (Index i = 0; i < y.cols(); ++i)
      x_bar_dot(0, i) =
          y(0, i) * std::fma(x_dot(0, i), y_bar(0, i), y_bar_dot(0, i));
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    forward(at, j, work);
  }
  void hessian(Point<T> at,
               BatchIn<T> target,
               BatchOut<T> h,
               Workspace& work) const override {
    forward(at, h, work);
    for (Index i = 0; i < h.cols(); ++i) h(0, i) *= 2 * h(0, i) - target(0, i);
  }
  void invert(Point<T> near,
              BatchIn<T> y,
              BatchOut<T> x,
              Workspace& /*work*/) const override {
    for (Index i = 0; i < y.cols(); ++i) {
      const T guess = near.x(0, i);
      x(0, i) = math::exp(guess) == y(0, i) ? guess : math::log(y(0, i));
    }
  }

 private:
  double lowest_;
};

}  // namespace

ProblemRecipe problems::exponential(const ExponentialOptions& options) {
  return problem<Exponential>(
      "exponential", options, {.unknowns = {"x"}, .observations = {"y"}});
}

}  // namespace physinv
