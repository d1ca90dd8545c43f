/// Which unknowns of Navier-Stokes pass through tanh.
#pragma once

#include <fmt/format.h>

#include <string>

#include "suite/core/batch.h"

namespace physinv::flow_bounds {

struct Choice {
  Index bounded;  ///< so many, from x0 on
  const char* title;

  /// A study for each; a table of all is with the first one.
  std::string name() const {
    return fmt::format("studies/navier-stokes-bounds-{}", bounded);
  }
};
inline constexpr Choice kChoices[] = {
    {0, "none"}, {1, "x0 (the suite's)"}, {3, "x0 and velocity"}};

}  // namespace physinv::flow_bounds
