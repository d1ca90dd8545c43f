/// Eight doubles that go through every operation together: one register of 512
/// bits, or two of 256. Their number decides about the order of sums and about
/// who searches with whom.
#pragma once

#include "suite/core/simd/math.h"
#include "suite/core/simd/registers.h"

namespace physinv::linalg {

inline constexpr Index kWidth = 8;

using Pack8 = FixedPack<double, kWidth>;
using Flags = FixedPack<std::int64_t, kWidth>;

PHYSINV_LANES Pack8 broadcast(double s) { return physinv::broadcast<Pack8>(s); }
PHYSINV_LANES Pack8 load(const double* p) { return physinv::load<Pack8>(p); }

/// Four numbers to a register.
using Four = NarrowPack<double>;
/// Eight vectors side by side, row i in x[i].
using Eight = Registers<Four, 2>;

}  // namespace physinv::linalg
