/// dlib's `find_min` (D. E. King, "dlib C++ library"). Strategies for the
/// direction and for the end are the caller's: those here are of dlib's manual.
#pragma once

#include <cstdint>
#include <memory>

#include "suite/core/method.h"
#include "task.h"

namespace libraries {

enum class DlibStrategy : std::uint8_t { bfgs, lbfgs };

struct DlibOptions {
  DlibStrategy strategy = DlibStrategy::bfgs;
  double min_delta = 1e-7;  ///< dlib's default: ends at a smaller change
  double min_loss = -1;     ///< no loss is as low; the manual's
  Index memory = 10;        ///< pairs of L-BFGS; the manual's

  auto fields() const {
    const bool bfgs = strategy == DlibStrategy::bfgs;
    return std::tuple{
        physinv::word("algorithm", bfgs ? "dlib_bfgs" : "dlib_lbfgs", strategy),
        physinv::field("min_delta", min_delta),
        physinv::field("min_loss", min_loss),
        physinv::field("memory", memory)};
  }
};

/// Stage `solve`: `find_min`, with bounds `find_min_box_constrained`, on the
/// true loss from the start. Ends as `gtol` where a line search changed the
/// loss by less than `min_delta`, as `maxiter`, or, where dlib throws, as
/// LibrarySolver says.
std::shared_ptr<const physinv::Stage> dlib_solve(
    const Task& task, const DlibOptions& options = {});

}  // namespace libraries
