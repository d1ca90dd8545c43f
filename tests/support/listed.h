/// A problem on given samples, whatever set is asked for.
#pragma once

#include <utility>

#include "suite/core/any_problem.h"

namespace physinv::test {

template <class T>
class Listed : public Problem<T>,
               public Vjp<T>,
               public Jvp<T>,
               public PullbackTangent<T>,
               public Jacobian<T>,
               public Hessian<T>,
               public Inverse<T> {
 public:
  Listed(const ProblemRecipe& of, Samples<double> samples)
      : of_(of), samples_(std::move(samples)) {}

  Shape shape() const override { return of_.shape(); }
  Vector<double> start() const override { return of_.start(); }
  double operations() const override { return of_.problem().operations(); }
  void draw(Stream&, SampleOut& sample) const override {
    if (drawn() == Drawn::both) sample.x = samples_.x.col(sample.index);
    sample.y = samples_.y.col(sample.index);
    sample.given = samples_.given.col(sample.index);
  }
  Drawn drawn() const override {
    return samples_.x.rows() > 0 ? Drawn::both : Drawn::observations;
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    of_.forward(at.x, at.given, y, work);
  }
  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override {
    of_.loss(y, target, loss);
  }
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override {
    of_.loss_gradient(y, target, y_bar);
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    of_.linearize(at.x, at.given, y, tape);
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    of_.pullback(tape, y_bar, x_bar, work);
  }
  void pushforward(const Tape& tape,
                   BatchIn<T> x_dot,
                   BatchOut<T> y_dot,
                   Workspace& work) const override {
    of_.pushforward(tape, x_dot, y_dot, work);
  }
  void pullback_tangent(const Tape& tape,
                        Directions<T> along,
                        BatchOut<T> x_bar_dot,
                        Workspace& work) const override {
    of_.pullback_tangent(tape, along, x_bar_dot, work);
  }
  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    of_.jacobian(at.x, at.given, j, work);
  }
  void hessian(Point<T> at,
               BatchIn<T> target,
               BatchOut<T> h,
               Workspace& work) const override {
    of_.hessian(at.x, at.given, target, h, work);
  }
  void invert(Point<T> near,
              BatchIn<T> y,
              BatchOut<T> x,
              Workspace& work) const override {
    of_.invert(y, near.given, near.x, x, work);
  }

 protected:
  AnyProblem<T> of_;
  Samples<double> samples_;
};

/// Provides what `of` does.
template <template <class> class P = Listed>
ProblemRecipe with_samples(ProblemRecipe of, const Samples<double>& samples) {
  ProblemRecipe all = of;
  all.make_float = [=] { return std::make_unique<P<float>>(of, samples); };
  all.make_double = [=] { return std::make_unique<P<double>>(of, samples); };
  return all;
}

}  // namespace physinv::test
