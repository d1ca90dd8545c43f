/// The robotic arm by the formulas of robotic_arm.h.
#pragma once

#include <array>

#include "problems/robotic_arm/robotic_arm.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm robotic_arm_closed_form(const RoboticArmOptions& o = {}) {
  return {[=](auto x, auto, auto y) {
    const std::array<Exact, 3> phi = {x[1], x[2] - x[1], x[3] - x[2] - x[1]};
    y[0] = 0, y[1] = x[0];
    for (std::size_t k = 0; k < 3; ++k) {
      y[0] += o.links[k] * cos(phi[k]), y[1] += o.links[k] * sin(phi[k]);
    }
  }};
}

}  // namespace physinv
