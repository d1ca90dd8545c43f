/// Problems y = A x whose side input, if any, does not enter: forward mode is
/// the forward pass, and the second derivative vanishes.
#pragma once

#include "suite/core/problem.h"

namespace physinv {

template <class T>
class LinearProblem : public Problem<T>,
                      public Vjp<T>,
                      public Jvp<T>,
                      public PullbackTangent<T> {
 public:
  void pushforward(const Tape& /*tape*/,
                   BatchIn<T> x_dot,
                   BatchOut<T> y_dot,
                   Workspace& work) const override {
    this->forward({x_dot, x_dot.topRows(0)}, y_dot, work);
  }
  void pullback_tangent(const Tape& tape,
                        Directions<T> along,
                        BatchOut<T> x_bar_dot,
                        Workspace& work) const override {
    this->pullback(tape, along.y_bar_dot, x_bar_dot, work);
  }
};

}  // namespace physinv
