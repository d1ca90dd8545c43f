/// The wave packet by the formula of wave_packet.h.
#pragma once

#include <cmath>

#include "problems/wave_packet/wave_packet.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm wave_packet_closed_form(const WavePacketOptions& o = {}) {
  return {[=](auto x, auto noise, auto y) {
    const long double w = o.frequency, width = o.width;
    const Exact t0 = static_cast<long double>(o.centre) +
                     static_cast<long double>(o.scale) * x[0];
    for (std::size_t k = 0; k < y.size(); ++k) {
      const Exact d = static_cast<long double>(k + 1) - t0;
      y[k] = static_cast<long double>(o.amplitude) *
                 std::cos(w * d + static_cast<long double>(o.phase)) *
                 exact_exp(-d * d / (2 * width * width)) +
             static_cast<long double>(noise[k]);
    }
  }};
}

}  // namespace physinv
