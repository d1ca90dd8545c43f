/// What the inverse-problem cases of the JPO paper compare: what a network
/// leaves to its refinement, what counts as solved; losses with those of BFGS
/// (suite/evidence/shares.h).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "suite/core/batch.h"
#include "suite/evidence/shares.h"
#include "suite/store/record.h"

namespace physinv {

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
