/// GSL's multidimensional minimizers with derivatives (the GNU Scientific
/// Library's manual, "Multidimensional Minimization"), which have no settings
/// by default: step, tol and the loop over iterations are those of the manual.
#pragma once

#include <memory>

#include "suite/core/method.h"
#include "task.h"

namespace libraries {

struct GslOptions {
  double step = 0.01;  ///< length of the first trial step
  double tol = 0.1;    ///< of a line search; the manual's for bfgs2

  auto fields() const {
    return std::tuple{physinv::word("algorithm", "gsl_vector_bfgs2"),
                      physinv::field("step", step),
                      physinv::field("tol", tol)};
  }
};

/// Stage `solve`: `vector_bfgs2` on the true loss from the start, until
/// |gradient|_2 is below the experiment's gtol. Ends as `gtol`, as `linesearch`
/// where GSL says that it makes no progress, or as `maxiter`; arrays and
/// message are those of LibrarySolver. Takes no bounds.
std::shared_ptr<const physinv::Stage> gsl_bfgs2(const Task& task,
                                                const GslOptions& options = {});

}  // namespace libraries
