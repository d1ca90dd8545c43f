/// Training after Newton steps of the physics (SIP paper, Eq. 4 and App. B.1;
/// saddle-free: Dauphin et al. 2014): as inverse_proxy does with an inverse,
///
///   min_theta  sum_i 1/2 |x_i - stop(x_i + dx_i)|^2,
///
/// with dx_i from gradient g and Hessian H = V diag(h) V^T of sample i's loss,
///
///   dx = -V s,   s_k = sign(q_k) min(|q_k / (h_k + damping)|, limit),
///   q = V^T g,
///
/// 0 where a denominator is but for rounding: |h_k + damping| <= d eps max_j
/// |h_j|, with d unknowns and eps the machine epsilon of the precision that H
/// was computed in. So far eigenvalues are from those of the exact matrix
/// (backward error, LAPACK Users' Guide, Sec. 4.7); NumPy's matrix_rank has the
/// same bound. Signs are those of the gradient: negative
/// curvature is flipped, so that every step goes down. Without `flip`, s_k =
/// q_k / (h_k + damping): to the stationary point, also where that is up.
///
/// `batch_loss` is that of the proxy. Gradient and Hessian that are not finite
/// make the step NaN.
#pragma once

#include <limits>

#include "optimizers/training/signal_recipe.h"

namespace physinv {

struct NewtonOptions {
  bool flip = true;
  double damping = 0;
  double limit = std::numeric_limits<double>::infinity();  ///< of |s_k|
};

SignalRecipe newton_proxy(const NewtonOptions& options = {});

/// dx of one sample; the Hessian is symmetric, `epsilon` that of the precision
/// that it was computed in.
Vector<double> newton_step(
    const NewtonOptions& options,
    const Vector<double>& gradient,
    const Batch<double>& hessian,
    double epsilon = std::numeric_limits<double>::epsilon());

}  // namespace physinv
