/// What the local inverse makes of a register of modes.
#pragma once

#include "problems/heat/heat.h"
#include "problems/heat/registers.h"
#include "suite/core/simd/math.h"

namespace physinv::heat_lanes {

/// |Z| beyond so many times its scale leaves nothing of a likelihood; within
/// the second there is something; within the third it is 1/2 to the last bit.
inline constexpr double kVanishes = 39, kRemains = 37, kCertain = 0x1p-28;

/// Of a register of fields.
struct Uncertainty {
  explicit Uncertainty(P u)
      : per(1 / u),
        vanishes((kVanishes * u) * (kVanishes * u)),
        certain((kCertain * u) * (kCertain * u)) {}
  P per, vanishes, certain;  ///< the latter of |Z|^2
};

/// `HeatMode::of`, lane by lane: 1 / expected and 1 / uncertainty for the
/// scales, e^-s and e^s for modes without and with a certain signal.
struct Modes {
  P probability, gain;

  PHYSINV_LANES static Modes of(P amplitude,
                                double s,
                                double damping,
                                double amplification,
                                double per_expected,
                                P per_uncertainty) {
    P z[] = {amplitude * per_expected, amplitude * per_uncertainty};
    // As squares of roots, which reach down to zero.
    for (P& v : z) v *= -0.25 * v;
    exp_lanes(z);
    for (P& v : z) v = held(0.5 * v * v);
    const P zero{}, one = 1 - zero;
    const P signal = select(z[0] == z[0], z[0], zero);
    const P all = signal + z[1];
    const P p = select(all == zero, zero, signal / all);
    const P w = select((p <= 0.5) | (p >= 0.68), 2 * (p - 0.5), zero);
    const P root = exp_lanes(0.5 * s * w);
    const P between = select(w == one, amplification - zero, root * root);
    return {p, select(w == -one, damping - zero, between)};
  }
};

/// What one mode of dy is multiplied by. Adds to `known` the lanes whose
/// probability is 0, 1/2 or 1 whatever the likelihoods are.
PHYSINV_LANES P gain_of(P re,
                        P im,
                        const HeatTable& table,
                        Index p,
                        Index q,
                        const Uncertainty& u,
                        Mask<double>& known) {
  const P squares = fma_lanes(re, re, im * im);
  const double expected = table.expected(p, q), damping = table.damping(p, q);
  const auto within = [&](double times) {
    return squares < (times * expected) * (times * expected);
  };
  const auto noise = ~within(kVanishes),
             signal = within(kRemains) & (squares > u.vanishes),
             nothing = within(kCertain) & (squares < u.certain);
  known -= noise | signal | nothing;
  const P zero{};
  const P sure =
      select(noise,
             damping - zero,
             select(signal, table.amplification(p, q) - zero, 1 - zero));
  if (count_set(noise | signal | nothing) == kWidth) return sure;
  const Modes modes = Modes::of(sqrt_lanes(squares),
                                table.s(p, q),
                                damping,
                                table.amplification(p, q),
                                1 / expected,
                                u.per);
  return select(noise, sure, modes.gain);
}

/// sqrt sum (1e-6 |dy| + floor)^2, dy = scale u
inline P uncertainty_of(const P* u, Index cells, double scale, double floor) {
  P sum{};
  for (Index r = 0; r < cells; ++r) {
    const P e = fma_lanes(abs_lanes(u[r]), 1e-6 * scale - P{}, floor - P{});
    sum = fma_lanes(e, e, sum);
  }
  return sqrt_lanes(sum);
}

}  // namespace physinv::heat_lanes
