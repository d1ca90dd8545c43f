/// The wave packet by the formula of wave_packet.h.
#pragma once

#include "problems/wave_packet/wave_packet.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm wave_packet_closed_form(const WavePacketOptions& o = {}) {
  return {[=](auto x, auto noise, auto y) {
    const Exact t0 = o.centre + o.scale * x[0];
    const DoubleDouble twice =
        2 * DoubleDouble(o.width) * DoubleDouble(o.width);
    for (std::size_t k = 0; k < y.size(); ++k) {
      const Exact d = double(k + 1) - t0;
      y[k] =
          o.amplitude * cos(o.frequency * d + o.phase) * exp(-d * d / twice) +
          noise[k];
    }
  }};
}

}  // namespace physinv
