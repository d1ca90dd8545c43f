/// Fresh problems of `NoisyAbsolute` by the million, one per lane: drawn,
/// differentiated at one point and forgotten. The same distributions as
/// `sample`, from numbers of 21 and 24 bits.
#pragma once

#include <numbers>

#include "problems/noisy_absolute/noisy_absolute.h"
#include "suite/core/rng_lanes.h"
#include "suite/core/simd/math.h"

namespace physinv {

template <class T>
class NoiseLanes {
 public:
  using Options = NoisyAbsoluteOptions;
  using P = Pack<T>;
  static constexpr const char* kSource = __FILE__;

  struct Problem {
    P gamma, solution, lambda, level;
  };

  explicit NoiseLanes(const Options& o)
      : options_(o),
        omega_min_(static_cast<T>(o.omega_min)),
        omega_step_(static_cast<T>((o.omega_max - o.omega_min) * 0x1p-21)) {}

  /// Everything but the noise.
  Problem draw(StreamLanes<T>& random) const {
    const T g = static_cast<T>(options_.gamma);
    Problem p;
    p.gamma = random.uniform(-g, g);
    p.solution = P{};
    if (options_.solution == Solution::linear) p.solution = 10 * p.gamma;
    if (options_.solution == Solution::sine)
      p.solution = sin_turns(p.gamma * std::numbers::inv_pi_v<T>);
    p.level = static_cast<T>(options_.level) - P{};
    if (options_.decades > 0) {
      const T d = static_cast<T>(options_.decades * std::numbers::ln10);
      p.level *= exp_lanes(random.uniform(-d, d));
    }
    p.lambda = static_cast<T>(options_.snr) * p.level;
    return p;
  }

  /// sum_j A_j w_j sin(w_j x + phi_j), the noise drawn on the spot for one
  /// point: there w_j x + phi_j is uniform over a turn because phi_j is,
  /// whatever x, so it is drawn itself. A scale common to all A cancels.
  [[gnu::noinline]] P noise(StreamLanes<T>& stream, P level) const {
    StreamLanes<T> random = stream;  // stays in registers
    P sum{}, square{};
    for (Index j = 0; j < options_.terms; ++j) {
      const auto drawn = random.whole_three();
      const P w = drawn.a * omega_step_ + omega_min_;
      const P aw = drawn.b * w;
      sum += aw * sin_of_turn(drawn.c * StreamLanes<T>::kUnit);
      square += aw * aw;
    }
    stream = random;
    const P norm = sqrt_lanes(square);
    return select(norm > P{}, level * sum / norm, P{});
  }

  const Options& options() const { return options_; }

 private:
  Options options_;
  T omega_min_, omega_step_;
};

}  // namespace physinv
