/// Batched solvers (batched_solver.h) whose problems do not wait for each
/// other: line searches, and descents with a step per problem. The bits of a
/// problem do not depend on the others in the batch.
#pragma once

#include <vector>

#include "optimizers/batched_solver.h"

namespace physinv {

class IndependentSolver : public BatchedSolver {
 public:
  bool supply_known() final;

 protected:
  /// An evaluated point.
  struct Point {
    const double* x;
    double loss;
    const double* gradient;
  };

  /// What becomes of a trial point that is the last one evaluated, to the bit:
  /// it is evaluated again, or, as in SciPy, its search continues with what is
  /// known of it.
  enum class KnownPoint : std::uint8_t { evaluate, reuse };
  explicit IndependentSolver(KnownPoint known) : known_point_(known) {}

  /// Problem i has its start, usable, as its iterate: the first trial point,
  /// or false if it ends.
  virtual bool begin(Index i, double* trial) = 0;
  /// An evaluation came back: the next trial point, or false if it ends.
  virtual bool advance(Index i, const Point& at, double* trial) = 0;

  /// `open` of the base, and what this class keeps.
  void open(BatchIn<double> x0);
  /// The point becomes the iterate.
  void accept(Index i, const Point& at);

 private:
  void take(VectorIn<double> loss, BatchIn<double> gradient) final;
  template <class F>
  void keep_active(F&& goes_on);
  bool answer(Index i, const Point& at, double* trial);
  bool open_run(Index i, const Point& at, double* trial);

  KnownPoint known_point_;
  Index known_ = 0;
  std::vector<char> knows_;              // whose trial point is the new iterate
  Vector<double> last_, last_gradient_;  // of the problem at hand
};

}  // namespace physinv
