/// Billiards by the formulas of billiards.h.
#pragma once

#include <cmath>

#include "problems/billiards/billiards.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm billiards_closed_form(const BilliardsOptions& o = {}) {
  return {[=](auto v, auto other, auto y) {
    const long double r = o.radius;
    const long double dx = other[0] - o.cue[0], dy = other[1] - o.cue[1];
    const Exact along = dx * v[0] + dy * v[1], across = dx * v[1] - dy * v[0];
    const Exact disc =
        4 * r * r * (v[0] * v[0] + v[1] * v[1]) - across * across;
    y[0] = other[0], y[1] = other[1];
    if (along.real() <= 0 ||
        disc.real() <= 1e-14L * along.real() * along.real())
      return;
    const Exact s = (dx * dx + dy * dy - 4 * r * r) / (along + std::sqrt(disc));
    const Exact left = 1.0L - static_cast<long double>(o.drag) * s;
    if (left.real() <= 1e-12L) return;
    const Exact push = (1 + static_cast<long double>(o.elasticity)) /
                       (2 * static_cast<long double>(o.drag)) * left *
                       std::sqrt(disc) / (4 * r * r);
    y[0] += push * (dx - v[0] * s), y[1] += push * (dy - v[1] * s);
  }};
}

}  // namespace physinv
