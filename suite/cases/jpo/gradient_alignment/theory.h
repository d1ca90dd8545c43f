/// How often noisy gradients, and the updates of a network trained with them,
/// point the right way: the theory of the JPO paper, Secs. 2-3, Apps. A, B.
#pragma once

#include <span>
#include <vector>

#include "suite/core/batch.h"

namespace physinv {

/// One sine of gradient amplitude a = A w against lambda:
/// 1/2 + asin(lambda / a) / pi, and 1 for lambda >= a.
double align_single_sine(double lambda, double a);

/// Many terms: 1/2 + erf(snr) / 2, and its first order 1/2 + snr / sqrt(pi).
double align_one(double snr);
double align_one_first_order(double snr);

/// Sum of n losses, equal noise: 1/2 + erf(snr sqrt(n)) / 2.
double align_sum(Index n, double snr);

/// Majority of n signs, each right with probability p = align_one(snr): the
/// exact binomial, a tie counts 1/2. No overflow for large n.
double align_vote(Index n, double snr);
/// A normal of mean n p and variance n p (1 - p) for it, e = p - 1/2:
/// 1/2 + erf(sqrt(n) e / sqrt(2 (1/4 - e^2))) / 2.
double align_vote_normal(Index n, double snr);
/// The same as the paper prints it, without the 2 below the root.
double align_vote_printed(Index n, double snr);

/// Response of a network (Theorem 3): how many of n examples one step moves
/// the right way. `complexity` C (times the support D of the predictions) and
/// `plasticity` A are the network's:
///
///   rho_1 = 1,  e = exp(-(N-1)/A),  q = C/(2N) + (1 - C/N) rho_{N-1}
///   rho_N = ((N-1) rho_{N-1} + (1-e) q + e) / N
///
/// For N < C the factor 1 - C/N is negative; `clamped` uses min(1, C/N).
/// Returns rho_1 .. rho_n.
struct Response {
  double complexity = 0, plasticity = 0;
  bool clamped = false;
};
std::vector<double> response_curve(Index n, const Response& response);

/// Noisy gradients right with probability q through a network that moves a
/// share rho along them: q rho + (1 - q)(1 - rho).
double align_combined(double q, double rho);

/// Least squares for rho at `sizes` over the grid C = 0.25..20, A = 0.25..30
/// in steps of 0.25.
struct ResponseFit {
  Response response;
  double rms = 0;
};
ResponseFit fit_response(std::span<const Index> sizes,
                         std::span<const double> measured);

}  // namespace physinv
