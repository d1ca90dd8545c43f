/// Scale-invariant training (SIP paper, Eq. 5): an inverse solver says where
/// the estimates should be, and the network follows it there,
///
///   min_theta  sum_i d(x_i - stop(x_i + dx_i)),   x_i + dx_i = P^-1(y_i; x_i),
///
/// dx_i being the distance to the problem's local inverse near x_i. No
/// derivative of the physics is asked for. The network is pushed by -dx with
/// half the square as d, by -sign(dx) with the sum of absolute values: steps of
/// one length, whatever the scale of the problem.
///
/// `batch_loss` is that of the proxy, not of the physics.
///
/// In double, the inverse is asked about observations and estimates in double,
/// whatever the network's precision: for inverses that tell signal from
/// rounding.
#pragma once

#include "optimizers/training/signal_recipe.h"

namespace physinv {

enum class ProxyNorm : std::uint8_t { square, absolute };

enum class ProxyPrecision : std::uint8_t { of_network, in_double };

SignalRecipe inverse_proxy(
    ProxyNorm norm = ProxyNorm::square,
    ProxyPrecision precision = ProxyPrecision::of_network);

}  // namespace physinv
