/// A library's minimizer as a batched solver of the suite
/// (optimizers/batched_solver.h): every problem runs on a fiber of its own, and
/// what all of them ask for is one batch of the oracle.
///
/// Whatever a library does is a result:
///
/// - An evaluation past the problem's budget throws `BudgetSpent` through the
///   library. One that swallows it kTries times is not resumed. The problem
///   ends as `maxiter`.
/// - What a library throws is a message; the problem keeps its last iterate and
///   ends as `linesearch`, after a loss or gradient that was not finite as
///   `nonfinite`.
/// - A point that is not finite is never shown to the problem; its loss and
///   gradient are NaN. One that the library returns is not taken: the problem
///   keeps its last iterate and ends as `nonfinite`.
///
/// An evaluation at the point of the last one, to the bit, is answered from it.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fiber.h"
#include "optimizers/independent_solver.h"
#include "suite/core/method.h"
#include "task.h"

namespace libraries {

using physinv::Index;
using physinv::Status;
using physinv::Vector;

/// Thrown out of an evaluation; a library lets it pass.
struct BudgetSpent {};

/// What a library's run has ended with, in the suite's words.
struct LibraryEnd {
  Vector<double> x;
  /// That of x, by the library; NaN if it names none.
  double loss = std::numeric_limits<double>::quiet_NaN();
  Status status = Status::maxiter;
  bool success = false;  ///< what the library calls so
  std::string message;   ///< in its words
};

/// One problem as a library sees it.
class Objective {
 public:
  virtual ~Objective() = default;
  /// The loss at x (d), and its gradient (d).
  virtual double evaluate(const double* x, double* gradient) = 0;
  /// x, which was evaluated, is the library's new iterate.
  virtual void iterate(const double* x) = 0;
};

/// Runs a library on one problem from x0, for so many iterations at most.
using Library = std::function<LibraryEnd(
    Objective& objective, const Vector<double>& x0, Index iterations)>;

class LibrarySolver final : public physinv::IndependentSolver {
 public:
  LibrarySolver(Library library, const Task& task);
  ~LibrarySolver() override;

  void start(physinv::BatchIn<double> x0) override;

  /// Adds to `out` the message (which ends, how many problems each) and arrays
  /// of 1 x examples, of what tables count: `claims_success`,
  /// `returned_not_best` (a lower loss was seen), `false_loss` (the library's
  /// is not that of x), `budget_spent` (of evaluations), `gradient_left` (its
  /// largest entry at x, projected on the bounds); where the task has bounds
  /// `outside_box`, how many evaluations were outside of them.
  void report(physinv::Outcome& out) const;

 private:
  struct Run;
  bool begin(Index i, double* trial) override;
  bool advance(Index i, const Point& at, double* trial) override;
  bool go_on(Index i, double* trial);
  bool conclude(Index i, double* trial);
  bool end(Index i, const Point* at);
  void move_to(Index i, const Point& at);
  bool is_iterate(Index i, const double* x) const;

  Library library_;
  Task task_;
  std::vector<std::unique_ptr<Run>> runs_;
};

}  // namespace libraries
