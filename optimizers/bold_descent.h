/// Gradient descent of a bold driver: longer steps while the loss falls, half
/// the step where it does not, every problem by itself (Navier-Stokes
/// experiment of the JPO paper; the adaptive rule of its library,
/// gradient_descent.h, lets problems of a batch wait for each other).
///
///   trial = x - a g / max(1, |g|)
///   L falls: x = trial, a *= longer    otherwise: a *= shorter
///
/// Where trial, loss or gradient are not finite, nothing falls; a start that is
/// not finite ends at once, as it is. Driven like `Bfgs`; the bits of a problem
/// do not depend on the others in the batch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/stop.h"

namespace physinv {

struct BoldDescentOptions {
  double first_step = 0.1;  ///< a
  double longer = 1.5, shorter = 0.5;
  Index evaluations = 100;  ///< trials
};

class BoldDescent {
 public:
  explicit BoldDescent(const BoldDescentOptions& options = {})
      : options_(options) {}

  /// Begins one run per column of x0 (d x n).
  void start(BatchIn<double> x0);

  bool pending() const { return !active_.empty(); }
  /// Problems that wait for an evaluation, ascending.
  std::span<const Index> active() const { return active_; }
  /// Where they want it, d x active().size(), in the same order.
  Eigen::Ref<const Batch<double>> points() const {
    return trial_.leftCols(static_cast<Index>(active_.size()));
  }
  void supply(VectorIn<double> loss, BatchIn<double> gradient);
  /// Ends what is still pending, with status `maxiter`.
  void halt() { active_.clear(); }

  /// Problems that moved in the last round; in the first those whose start is
  /// usable.
  std::span<const Index> accepted() const { return accepted_; }

  const Batch<double>& x() const { return x_; }
  const Vector<double>& loss() const { return loss_; }
  /// `gtol`: a gradient of zero; `nonfinite`: no usable start; `maxiter`.
  const std::vector<Status>& status() const { return status_; }
  const std::vector<Index>& iterations() const { return iterations_; }
  const std::vector<Index>& evaluations() const { return evaluations_; }
  std::uint64_t skipped_evaluations() const { return skipped_; }

 private:
  bool take(Index i, Index at, double loss, VectorIn<double> gradient);

  BoldDescentOptions options_;
  std::uint64_t skipped_ = 0;
  Batch<double> x_, gradient_, trial_;
  Vector<double> loss_, step_;
  std::vector<Status> status_;
  std::vector<Index> iterations_, evaluations_, active_, accepted_;
};

}  // namespace physinv
