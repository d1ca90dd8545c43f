/// Billiards by the formulas of billiards.h.
#pragma once

#include "problems/billiards/billiards.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm billiards_closed_form(const BilliardsOptions& o = {}) {
  return {[=](auto v, auto other, auto y) {
    const double r = o.radius;
    const Exact dx = other[0] - o.cue[0], dy = other[1] - o.cue[1];
    const Exact along = dx * v[0] + dy * v[1], across = dx * v[1] - dy * v[0];
    const Exact reach = DoubleDouble(4 * r) * DoubleDouble(r);
    const Exact disc = reach * (v[0] * v[0] + v[1] * v[1]) - across * across;
    y[0] = other[0], y[1] = other[1];
    if (along.value <= 0 || disc.value <= 1e-14 * along.value * along.value)
      return;
    const Exact s = (dx * dx + dy * dy - reach) / (along + sqrt(disc));
    const Exact left = 1 - Exact(o.drag) * s;
    if (left.value <= 1e-12) return;
    const Exact push = (1 + Exact(o.elasticity)) / (2 * Exact(o.drag)) * left *
                       sqrt(disc) / reach;
    y[0] += push * (dx - v[0] * s), y[1] += push * (dy - v[1] * s);
  }};
}

}  // namespace physinv
