/// What the inverse-problem cases of the JPO paper compare: losses with those
/// of BFGS, what a network leaves to its refinement, what counts as solved.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "suite/core/batch.h"
#include "suite/store/record.h"

namespace physinv {

/// When two losses count as equal: bitwise, |a - b| <= 1e-6 |b|, or 1e-3 |b|,
/// which is nothing where solvers end at kinks.
enum class Equality { strict, tol, band };

/// Shares of problems on which a method ends below, at or above BFGS.
struct Shares {
  double better = 0, equal = 0, worse = 0;
  /// f_N = N_better / N + N_equal / (2 N).
  double f() const { return better + 0.5 * equal; }
};

/// A loss that is not finite is worse; a finite one is better than a BFGS
/// loss that is not. Sizes must agree and be positive.
Shares compare_losses(VectorIn<double> loss,
                      VectorIn<double> bfgs,
                      Equality equality);

/// Share of the decrease made before the refinement, mean over problems:
/// (start - fit) / (start - min(fit, refined)). Problems without decrease are
/// left out; empty if none is left.
std::optional<double> decrease_share(VectorIn<double> start,
                                     VectorIn<double> fit,
                                     VectorIn<double> refined);

/// When a problem counts as solved. A number means a loss below it; any other
/// test sees the data of the case, so that it may ask for the truth.
class Solved {
 public:
  using Test =
      std::function<bool(const CaseData&, const StageRecord&, Index example)>;

  Solved(double loss);  // NOLINT(google-explicit-constructor)
  Solved(Test test, std::string says)
      : test_(std::move(test)), says_(std::move(says)) {}

  bool operator()(const CaseData& data,
                  const StageRecord& stage,
                  Index example) const {
    return test_(data, stage, example);
  }
  /// How many of the stage's examples.
  Index count(const CaseData& data, const StageRecord& stage) const;
  /// "loss < 1e-06"
  const std::string& says() const { return says_; }

 private:
  Test test_;
  std::string says_;
};

/// max_j |x_j - truth_j| < tolerance; an estimate that is not finite is not.
Solved within_of_truth(double tolerance);

}  // namespace physinv
