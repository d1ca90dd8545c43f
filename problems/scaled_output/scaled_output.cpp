#include "problems/scaled_output/scaled_output.h"

#include "suite/core/check.h"
#include "suite/core/linear_problem.h"
#include "suite/core/math.h"
#include "suite/core/option_check.h"

namespace physinv {
namespace {

/// out <- f(i, x_1, x_2) of every column, from plain pointers: columns are too
/// short for Eigen's.
template <class T, class F>
void for_columns(BatchIn<T> in, BatchOut<T>& out, F f) {
  const Index from = in.outerStride(), to = out.outerStride();
  const T* const x = in.data();
  T* const y = out.data();
  for (Index i = 0; i < in.cols(); ++i)
    f(i, x[from * i], x[from * i + 1], y + to * i);
}

template <class T>
void scale(T gamma, BatchIn<T> in, BatchOut<T>& out) {
  for_columns<T>(
      in, out, [=](Index, T a, T b, T* y) { y[0] = a, y[1] = gamma * b; });
}

/// 0, or NaN at a point that is not finite: the map is linear, but its
/// derivatives must say where they were asked for.
template <class T>
T poison(T a, T b) {
  return T(0) * a + T(0) * b;
}

enum Slot : std::size_t { kPoison };

template <class T>
class ScaledOutput final : public LinearProblem<T>, public Jacobian<T> {
 public:
  explicit ScaledOutput(const ScaledOutputOptions& options)
      : options_(options) {
    check_numbers<T>({{"gamma", options.gamma}});
    SUITE_CHECK(options.gamma > 0, "gamma must be positive");
  }

  Shape shape() const override { return {2, 2, 1}; }
  Vector<double> start() const override { return Vector<double>::Zero(2); }

  /// t uniform in [-1, 1), y = (sin 6 t, cos 9 t), x = (y_1, y_2 / gamma).
  void draw(Stream& stream, SampleOut& s) const override {
    const double t = s.given(0) = stream.uniform(-1, 1);
    s.y << math::sin(6 * t), math::cos(9 * t);
    s.x << s.y(0), s.y(1) / options_.gamma;
  }
  Drawn drawn() const override { return Drawn::both; }

  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    scale<T>(T(options_.gamma), at.x, y);
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto& x = at.x;
    auto kept = tape.slot<T>(kPoison, 1, x.cols());
    for_columns<T>(x,
                   y,
                   [gamma = T(options_.gamma), zero = kept.data()](
                       Index i, T a, T b, T* out) {
                     zero[i] = poison(a, b);
                     out[0] = a, out[1] = gamma * b;
                   });
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    const auto kept = tape.view<T>(kPoison);
    for_columns<T>(y_bar,
                   x_bar,
                   [gamma = T(options_.gamma), zero = kept.data()](
                       Index i, T a, T b, T* out) {
                     out[0] = a + zero[i], out[1] = gamma * b + zero[i];
                   });
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace&) const override {
    const auto& x = at.x;
    for (Index i = 0; i < x.cols(); ++i) {
      const T zero = poison(x(0, i), x(1, i));
      j.col(i) << T(1) + zero, zero, zero, T(options_.gamma) + zero;
    }
  }

  double operations() const override { return 1; }

 private:
  ScaledOutputOptions options_;
};

}  // namespace

ProblemRecipe problems::scaled_output(const ScaledOutputOptions& options) {
  return problem<ScaledOutput>(
      "scaled_output",
      options,
      {.unknowns = {"x_1, x_2"}, .observations = {"z_1, z_2"}, .given = {"t"}});
}

}  // namespace physinv
