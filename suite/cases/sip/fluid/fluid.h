/// The fluid experiments: where the vortex is thought to be on the way back, by
/// the authors' code and by the time itself.
#pragma once

#include "suite/core/batch.h"

namespace physinv::fluid_case {

inline constexpr Index kCells = 64;    ///< per side
inline constexpr Index kLong = 20000;  ///< updates of the authors' plots

struct Variant {
  const char *experiment, *title;
  bool timed_path;
};

inline constexpr Variant kCode{"sip/fluid", "Fluid", false};
inline constexpr Variant kTimed{
    "sip/fluid-timed", "Fluid, the vortex's path timed", true};

}  // namespace physinv::fluid_case
