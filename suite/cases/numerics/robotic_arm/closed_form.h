/// The robotic arm by the formulas of robotic_arm.h.
#pragma once

#include <array>
#include <cmath>

#include "problems/robotic_arm/robotic_arm.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm robotic_arm_closed_form(const RoboticArmOptions& o = {}) {
  return {[=](auto x, auto, auto y) {
    const std::array<Exact, 3> phi = {x[1], x[2] - x[1], x[3] - x[2] - x[1]};
    y[0] = 0, y[1] = x[0];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto link = static_cast<long double>(o.links[k]);
      y[0] += link * std::cos(phi[k]), y[1] += link * std::sin(phi[k]);
    }
  }};
}

}  // namespace physinv
