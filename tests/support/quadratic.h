/// A problem everybody must solve: y = A x + given, two unknowns, A regular.
#pragma once

#include <cstring>
#include <limits>
#include <vector>

#include "optimizers/network_model.h"
#include "suite/core/method.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv::test {

struct QuadraticOptions {
  double broken_above = 1e300;  ///< y is NaN where x(0) is larger
  auto fields() const {
    return std::tuple{physinv::field("broken_above", broken_above)};
  }
};

/// By its gradients alone.
template <class T>
class GradientQuadratic : public Problem<T>, public Vjp<T> {
 public:
  using Options = QuadraticOptions;
  explicit GradientQuadratic(const Options& options = {}) : options_(options) {}

  static Eigen::Matrix<T, 2, 2> matrix() {
    return (Eigen::Matrix<T, 2, 2>() << 1, T(0.5), T(-0.25), T(0.75))
        .finished();
  }
  Shape shape() const override { return {2, 2, 2}; }
  Vector<double> start() const override { return Eigen::Vector2d(0.5, -0.5); }
  void draw(Stream& stream, SampleOut& sample) const override {
    for (Index j = 0; j < 2; ++j) sample.x(j) = stream.uniform(-1, 1);
    for (Index j = 0; j < 2; ++j) sample.given(j) = stream.uniform(-1, 1);
    sample.y = GradientQuadratic<double>::matrix() * sample.x + sample.given;
  }
  /// So that problems can be solved where the physics are broken.
  Drawn drawn() const override { return Drawn::both; }
  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    const auto &x = at.x, &given = at.given;
    for (Index i = 0; i < x.cols(); ++i) {
      y.col(i) = matrix() * x.col(i) + given.col(i);
      if (x(0, i) > T(options_.broken_above)) y.col(i).setConstant(kNan);
    }
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape&) const override {
    Workspace none;
    forward(at, y, none);
  }
  void pullback(const Tape&,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    for (Index i = 0; i < y_bar.cols(); ++i)
      x_bar.col(i) = matrix().transpose() * y_bar.col(i);
  }
  double operations() const override { return 8; }

 protected:
  static constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
  Options options_;
};

template <class T>
class Quadratic final : public GradientQuadratic<T>,
                        public Jacobian<T>,
                        public Jvp<T>,
                        public PullbackTangent<T> {
 public:
  using GradientQuadratic<T>::GradientQuadratic;

  void pushforward(const Tape&,
                   BatchIn<T> x_dot,
                   BatchOut<T> y_dot,
                   Workspace&) const override {
    for (Index i = 0; i < x_dot.cols(); ++i)
      y_dot.col(i) = this->matrix() * x_dot.col(i);
  }
  void pullback_tangent(const Tape& tape,
                        Directions<T> along,
                        BatchOut<T> x_bar_dot,
                        Workspace& work) const override {
    this->pullback(tape, along.y_bar_dot, x_bar_dot, work);
  }

  void jacobian(Point<T> at, BatchOut<T> j, Workspace&) const override {
    const auto& x = at.x;
    const auto a = this->matrix();
    for (Index i = 0; i < x.cols(); ++i) {
      j.col(i) = a.reshaped();
      if (x(0, i) > T(this->options_.broken_above))
        j.col(i).setConstant(this->kNan);
    }
  }
};

extern template class GradientQuadratic<float>;
extern template class GradientQuadratic<double>;
extern template class Quadratic<float>;
extern template class Quadratic<double>;

ProblemRecipe quadratic(const QuadraticOptions& options = {});

/// Small networks for it.
Setting quadratic_setting(double output_scale = 1);

/// A stage by itself, with everything a test may want to see afterwards.
struct StageBench {
  explicit StageBench(const Stage& stage,
                      Index n = 8,
                      Index iterations = 10,
                      const ProblemRecipe& recipe = quadratic(),
                      Setting a_setting = quadratic_setting());

  Outcome run(const Outcome* previous = nullptr,
              Precision precision = Precision::f64);

  /// True losses of any estimates.
  Vector<double> loss(const Batch<double>& x);
  /// Traced blocks of `bytes` bytes as columns.
  template <class T>
  Batch<T> traced(Index rows) const {
    std::vector<const std::vector<char>*> found;
    for (const auto& block : trace)
      if (block.size() == sizeof(T) * static_cast<std::size_t>(rows))
        found.push_back(&block);
    Batch<T> columns(rows, static_cast<Index>(found.size()));
    for (std::size_t j = 0; j < found.size(); ++j)
      std::memcpy(columns.col(static_cast<Index>(j)).data(),
                  found[j]->data(),
                  found[j]->size());
    return columns;
  }

  const Rng root = Rng::root("stage_bench", 5);
  Setting setting;
  Oracle oracle;
  Probe probe;
  std::vector<std::vector<char>> trace;
  Checkpoint* checkpoint = nullptr;

 private:
  const Stage& stage_;
};

}  // namespace physinv::test
