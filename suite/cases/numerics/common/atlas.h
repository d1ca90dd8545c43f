/// The atlas of all problems: parameters over their whole range and beyond it,
/// as sweeps over two axes (suite/diagnostics/stability_sweep.h), and what
/// accuracy costs (accuracy.h). A problem enters it by saying what its axes and
/// parameters are.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "suite/cases/numerics/common/accuracy.h"
#include "suite/cases/numerics/common/sweep_axis.h"
#include "suite/core/recipe.h"
#include "suite/harness/registry.h"

namespace physinv {

struct Sweep {
  std::string id;     ///< of the stage, table and figure
  std::string title;  ///< "Aim and speed"
  SweepAxis x, y;
  /// Unknowns at a point of the axes.
  std::function<Vector<double>(double x, double y)> point;
  /// One for all, or one for each value of y.
  std::vector<ProblemRecipe> problems;
  double zero = 1e-30;  ///< see StabilitySweepOptions
  Index examples = 1;
};

/// size cos(1.1 k): alternates in sign and size, so that no symmetry helps.
Vector<double> uneven(Index rows, double size);

struct Atlas {
  std::string name;   ///< numerics/billiards
  std::string title;  ///< Numerics of billiards
  Citation citation;
  std::vector<Sweep> sweeps;
  std::vector<NumericalParameter> parameters = {};
  ProblemRecipe problem = {};  ///< as it is registered; none: that of a sweep
};

/// An experiment with the method `stability`, a stage per sweep, a table and
/// maps of each, and the claim N1 about all adjoints; with parameters the
/// method `work-precision` and claims about observed orders, too.
void add_atlas(Registry& r, Atlas atlas);

/// Those registered, in any order.
const std::vector<Atlas>& atlases();

}  // namespace physinv
