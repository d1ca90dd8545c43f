/// Stages that look instead of solving: what they find are arrays of the
/// record; their estimate is the start.
#pragma once

#include "suite/core/method.h"
#include "suite/core/recipe.h"

namespace physinv {

class Diagnostic : public Stage {
 public:
  explicit Diagnostic(const char* source = __builtin_FILE()) : Stage(source) {}
  /// Of the class, and of the problems it looks at.
  Sources sources() const override;
  Needs needs() const override { return Needs::forward; }
  /// `algorithm=diagnostic` first, then what the kind adds.
  Options options() const final;
  Index default_iterations() const override { return 1; }
  bool takes_row_iterations() const override { return false; }
  Outcome run(StageRun& run) const final;

 protected:
  virtual std::string kind() const = 0;
  virtual Options settings() const = 0;
  /// Those it looks at, in addition to the experiment's.
  virtual std::vector<ProblemRecipe> problems() const { return {}; }
  /// Fills `out.arrays`, every number finite, and starts the solving clock.
  virtual void diagnose(StageRun& run, Outcome& out) const = 0;
};

/// Hash of a problem's name and options, for the options of a stage.
std::string fingerprint(const std::vector<ProblemRecipe>& problems);

/// |a - b| / |b| in the norm of all entries; not finite if one of them is not.
double relative_distance(VectorIn<double> a, VectorIn<double> b);

/// What is not finite has no number: -1 in arrays of what is never negative.
double number_or_none(double value);

}  // namespace physinv
