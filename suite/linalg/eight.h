/// Eight doubles that go through every operation together: one register of 512
/// bits, or two of 256. Their number decides the order of sums and which values
/// are searched together.
#pragma once

#include "suite/core/simd/math.h"
#include "suite/core/simd/registers.h"

namespace physinv::linalg {

inline constexpr Index kWidth = 8;

using Pack8 = FixedPack<double, kWidth>;
using Flags = FixedPack<std::int64_t, kWidth>;

PHYSINV_LANES Pack8 broadcast(double s) { return physinv::broadcast<Pack8>(s); }
PHYSINV_LANES Pack8 load(const double* p) { return physinv::load<Pack8>(p); }

/// One register of a Pack8, and how many it has.
using Part = Pack<double>;
inline constexpr int kParts = sizeof(Pack8) / sizeof(Part);
inline constexpr Index kPartWidth = kWidth / kParts;

template <class P>
PHYSINV_LANES Pack8 from_parts(const P* parts) {
  using Whole = FixedPack<LaneScalar<P>, kWidth>;
  if constexpr (kParts == 1) {
    return parts[0];
  } else {
    return Whole::make([&](int k) { return parts[k]; });
  }
}

/// Half of them, in a register of 256 bits.
using Four = NarrowPack<double>;

}  // namespace physinv::linalg
