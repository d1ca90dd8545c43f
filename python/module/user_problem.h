/// Problems written in Python: their functions as abilities of a problem.
/// A batch is one call; functions see double, whatever the precision.
///
/// A column of x that is not finite is NaN in y and in all derivatives; the
/// function sees the start there. What a function raises, or returns in another
/// shape, is a std::runtime_error that names it.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "python/module/arrays.h"
#include "suite/core/recipe.h"

namespace physinv::python {

/// Functions of arrays (samples, features), as physinv/_problems.py makes them;
/// None where a problem lacks one.
struct Functions {
  std::string name;  ///< of the experiment
  Shape shape;
  Vector<double> start;
  double operations = 1;
  py::object sample,  ///< (seed, n) -> x, given
      forward,        ///< (x, given) -> y
      vjp,            ///< (x, given) -> y, pullback: y_bar -> x_bar
      jvp,            ///< (x, given, x_dot) -> y_dot; needs vjp
      jacobian,       ///< (x, given) -> (samples, observations, unknowns)
      inverse;        ///< (y, given, guess) -> x

  /// vjp, jvp, jacobian, inverse
  std::array<bool, 4> can() const {
    return {!vjp.is_none(),
            !vjp.is_none() && !jvp.is_none(),
            !jacobian.is_none(),
            !inverse.is_none()};
  }
};

/// Takes the lock of the interpreter when they are destroyed.
std::shared_ptr<const Functions> shared(Functions functions);

ProblemRecipe recipe_of(const std::shared_ptr<const Functions>& functions,
                        const std::string& name,
                        Options options,
                        Quantities quantities);

}  // namespace physinv::python
