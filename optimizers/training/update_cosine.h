/// Scale-invariant training that looks at its own updates (SIP paper, App.
/// A.2): do they move the estimates where the inverse solver wants them?
///
///   cosine of the angle between  mean_i (x_i' - x_i)  and  mean_i dx_i
///
/// over an update's batch: x_i its estimates before, x_i' behind the update,
/// x_i + dx_i = P^-1(y_i; x_i) in double; 0 where a mean is 0. Looked at are
/// the updates that follow a point of the curve.
#pragma once

#include "optimizers/training/proxy.h"

namespace physinv {

/// The updates of `inverse_proxy`, to the bit. Leaves `update_cosine` (1 x
/// updates looked at) in addition to what it leaves. For first-order rules; the
/// passes of looking are counted, but not timed.
SignalRecipe proxy_with_cosines(
    ProxyNorm norm = ProxyNorm::square,
    ProxyPrecision precision = ProxyPrecision::of_network);

}  // namespace physinv
