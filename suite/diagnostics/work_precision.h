/// One point of a work-precision diagram: how far one setting of a problem is
/// from what is right, and what a forward pass, a gradient or an inverse costs.
///
/// Samples and what is given are drawn from `base`, the coarsest setting.
/// Problems with a multiple of its unknowns see the same function of time,
/// constant over each of the base's steps, and their gradients are added up
/// over it. What is given on a multiple of its points is the same periodic
/// function. Of a multiple of its observations every so-many-th is compared,
/// and gradients are means over them. The gradient is that of the problem's
/// own loss; its target is the next sample's observation. The inverse is asked
/// for the unknowns of the samples' observations, from the problem's start.
///
/// Every iteration is one pass of all samples, so that the curve's seconds hold
/// the time of each. Array `error` (1 x samples): |y - y_ref| / |y_ref| or the
/// same of the gradients or the unknowns; -1 where they are not finite.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "suite/core/closed_form.h"
#include "suite/core/curve.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv {

enum class WorkOf : std::uint8_t { forward, gradient, inverse };

/// "forward"
const char* to_string(WorkOf what);

/// What is right, once found, for the stages of one parameter that ask for it.
class Answers;
std::shared_ptr<Answers> no_answers_yet();

struct WorkPrecisionOptions {
  std::string name;  ///< of the stage
  ProblemRecipe problem, base;
  /// What is right: the finest setting in double, or a closed form instead.
  ProblemRecipe reference = {};
  ClosedForm exact = {};
  WorkOf of = WorkOf::forward;
  Index samples = 0;  ///< 0: as many as the case has
  Index block = 0;    ///< samples per call, 0 for all of them
  Index repetitions = 10;
  /// Shared by stages of the same base and reference, which then make the
  /// reference once. Empty: each makes its own.
  std::shared_ptr<Answers> answers = {};

  /// Those it looks at.
  std::vector<ProblemRecipe> problems() const;
  auto fields() const {
    return std::tuple{
        word("settings", fingerprint(problems()), problem, base, reference),
        field("of", of),
        field("samples", samples),
        field("block", block),
        if_changed(field("right", exact)),
        implied(name, repetitions, answers)};
  }
};

std::shared_ptr<const Stage> work_precision(WorkPrecisionOptions options);

/// Seconds of the fastest repetition on record; 0 for none.
double fastest_repetition(const Curve& curve);

}  // namespace physinv
