/// The matrix row of a problem that is not the suite's, made while the program
/// runs: the experiment matrix/<name> with all methods of the matrix, and the
/// solvers and networks that a whole problem is compared by,
///
///   bfgs, lbfgsb, gd              from the problem's start
///   jpo, supervised, na           networks, refined by BFGS
///
/// each where the problem provides what it needs. Networks are dense layers
/// over given and observations (of the neural adjoint: unknowns and given).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "suite/cases/matrix/cells/cells.h"
#include "suite/harness/case.h"

namespace physinv::matrix {

/// Of the matrix alone.
Experiment experiment(const MatrixProblem& problem);

struct OwnOptions {
  std::string name, title;
  ProblemRecipe problem;
  Shape shape = {};
  double gtol = 1e-8;
  std::vector<Index> hidden = {64, 64, 64};  ///< features of the layers
  Index n = 32;             ///< problems of a case, but in profile smoke
  Index iterations = 1000;  ///< of networks on the problems of a case
  Index updates = 1000;     ///< of networks on fresh samples, and their batch
  Index batch = 32;
};

/// Its row, which `add_problem` takes.
MatrixProblem own_row(const OwnOptions& options);

Experiment own_experiment(const OwnOptions& options);

/// Methods that the problem cannot carry, each with what is missing.
std::vector<std::pair<std::string, std::string>> skipped_methods(
    const MatrixProblem& problem);

/// A table of all its methods; those that are skipped say why.
Section own_report(const MatrixProblem& problem, const Evidence& evidence);

}  // namespace physinv::matrix
