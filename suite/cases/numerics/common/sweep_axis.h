/// What a sweep varies.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "suite/core/recipe.h"

namespace physinv {

/// A sweep over a grid: point number j * x.size() + i lies at (x[i], y[j]).
struct SweepAxis {
  std::string label;
  std::vector<double> values;
  bool log = false;
};

/// Powers of ten, 10^first, 10^(first + step) .. 10^last.
std::vector<double> decades(double first, double last, double step = 1);

/// One problem for each value of an axis.
std::vector<ProblemRecipe> along(
    const SweepAxis& axis, const std::function<ProblemRecipe(double)>& problem);

}  // namespace physinv
