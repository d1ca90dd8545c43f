/// The matrix: every rule and signal of the house on every problem that has a
/// network. One batch size per problem, fresh samples for every update, single
/// precision; each method brings five rates of its own, and a search on data of
/// its own picks one per run (optimizers/rate_search.h).
#pragma once

#include <string>
#include <vector>

#include "optimizers/rate_search.h"
#include "suite/core/recipe.h"

namespace physinv::matrix {

struct MatrixMethod {
  std::string id, title;
  bool half_inverse = false;  ///< wants the network's Jacobian by rows
  TrainingOptions options;
  std::vector<double> rates;
};
const std::vector<MatrixMethod>& methods();

struct MatrixProblem {
  std::string id, title;
  ProblemRecipe problem;
  Setting setting;
  Index batch, updates;
  /// Its network gives its Jacobian by rows (RowJacobian).
  bool rows = true;
  Index n = 128;  ///< problems of a case, but in profile smoke

  std::string experiment() const { return "matrix/" + id; }
};
const std::vector<MatrixProblem>& problems();

/// A row of the matrix in addition to the suite's own (own.h); it replaces one
/// of the same id.
void add_problem(MatrixProblem problem);

/// Why this cell is empty; nothing if it is not.
std::string refusal(const MatrixProblem& problem, const MatrixMethod& method);

}  // namespace physinv::matrix
