/// How fluids are carried: what a thousand steps do to the energy of a periodic
/// flow, and the order of MacCormack advection.
#pragma once

#include <memory>

#include "suite/core/method.h"

namespace physinv {

/// A thousand steps of flows as the SIP paper draws them
/// (problems/marker_flow), on 32 x 32 cells. Arrays, samples x points:
///   energy, energy_single  |E(t) - E(0)| / E(0), in double and in float
///   unscaled   share of E(0) that is left if no step is scaled to the energy
///              that was there before
///   divergence  largest net flow out of a cell, over the largest velocity
/// `step` (1 x points). -1: not finite.
std::shared_ptr<const Stage> energy_drift();

/// Root mean square errors of a smooth field after it was carried for half a
/// unit of time on a periodic unit square, by a constant velocity and by a
/// shear flow, in steps of half a cell: `constant`, `shear` (1 x grids); after
/// one step, largest where the limiter does not act: `free` (1 x grids).
/// `cells` (1 x grids).
std::shared_ptr<const Stage> advection_order();

}  // namespace physinv
