/// What a run ends with.
#pragma once

#include <limits>
#include <set>
#include <string>

#include "suite/app/options.h"
#include "suite/harness/screen.h"

namespace physinv {

struct RunEnd {
  std::string out;      ///< the store
  Selection selection;  ///< its filters are already regular expressions
  std::set<std::string> experiments;  ///< that the run was about
  int jobs = 1;
  Screen screen;
  /// By `wall_now`: pages that would not be written by then are left out.
  double until = std::numeric_limits<double>::infinity();
};

/// Writes the page of the store. Prints for each experiment what was measured
/// next to what the paper has, where this profile can decide it, in at most
/// eight lines; the page, or that a budget has no time for it; and what decides
/// the paper's other statements.
void conclude(const RunEnd& end);

}  // namespace physinv
