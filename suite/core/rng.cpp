#include "suite/core/rng.h"

#include <Random123/philox.h>

#include <cmath>
#include <numbers>

#include "suite/core/hash.h"
#include "suite/core/math_lanes.h"
#include "suite/core/simd/pack.h"

namespace physinv {

std::uint64_t Stream::bits() {
  if (left_ == 0) {
    const r123::Philox4x64::ctr_type counter = {{counter_++, 0, 0, 0}};
    const r123::Philox4x64::key_type key = {{key_, mix64(~key_)}};
    const auto out = r123::Philox4x64()(counter, key);
    for (std::size_t i = 0; i < 4; ++i) block_[i] = out[i];
    left_ = 4;
  }
  return block_[static_cast<std::size_t>(4 - left_--)];
}

double Stream::uniform() {
  return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

double Stream::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double r = std::sqrt(-2.0 * math::log1p(-uniform()));
  const double angle = 2.0 * std::numbers::pi * uniform();
  const auto [sine, cosine] = math::sincos(angle);
  spare_ = r * sine;
  has_spare_ = true;
  return r * cosine;
}

void Stream::normals(double* to, Index count) {
  constexpr Index w = kLanes<double>;
  using P = Pack<double>;
  if (count > 0 && has_spare_) *to++ = normal(), --count;
  for (; count >= 2 * w; count -= 2 * w, to += 2 * w) {
    P share, turn;
    for (Index l = 0; l < w; ++l) share[l] = uniform(), turn[l] = uniform();
    const P r = sqrt_lanes(-2.0 * math::log1p(-share));
    const auto [sine, cosine] = math::sincos(2.0 * std::numbers::pi * turn);
    const P even = r * cosine, odd = r * sine;
    for (Index l = 0; l < w; ++l) to[2 * l] = even[l], to[2 * l + 1] = odd[l];
  }
  for (; count > 0; --count) *to++ = normal();
}

Rng Rng::root(std::string_view experiment, std::uint64_t seed) {
  return Rng(hash_text(experiment)).child(seed);
}

Rng Rng::child(std::string_view name) const {
  return Rng(hash_text(name, mix64(key_ + 1)));
}

Rng Rng::child(std::uint64_t i) const {
  return Rng(mix64(key_ + mix64(i + 0x9e3779b97f4a7c15ULL)));
}

}  // namespace physinv
