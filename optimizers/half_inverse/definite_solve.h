/// Gauss-Newton while the cut removes nothing: v = G^{-1} g by one Cholesky
/// factorisation (m^3 / 3 flops), behind a proof.
///
/// G - theta I is factored, with theta above the squared cut plus everything
/// rounding may have done. If that succeeds, every singular value exceeds the
/// cut. The shifted factor then solves G v = g by refinement, which gains a
/// factor theta / (lambda_min - theta) a round.
#pragma once

#include <vector>

#include "optimizers/half_inverse/power.h"
#include "suite/linalg/symmetric_update.h"

namespace physinv::hig {

class DefiniteSolve {
 public:
  /// False, with v undefined, where kappa is not -1, beta is not 0, the proof
  /// fails, or the refinement does not come below `tolerance`: use another
  /// path. In the report s_max is an upper and smallest_kept a lower bound;
  /// `error` bounds the relative error of the update for this G.
  bool operator()(BatchIn<double> gram,
                  VectorIn<double> g,
                  const Power& power,
                  double tolerance,
                  VectorOut<double> v,
                  PowerReport& report,
                  double gram_noise = 1);

  /// Whether the last call factored anything.
  bool began() const { return began_; }
  std::size_t bytes() const {
    return (gram_.size() + factor_.size()) * sizeof(double);
  }

 private:
  bool refine(VectorIn<double> g,
              double enough,
              VectorOut<double> v,
              PowerReport& report);
  linalg::Symmetric padded(std::vector<double>& storage);

  Index m_ = 0;
  std::vector<double> gram_, factor_;  ///< memory rows of Symmetric
  std::vector<double> v_, product_, residual_, step_;  ///< padded
  linalg::SymmetricProduct multiply_;
  bool began_ = false;
};

}  // namespace physinv::hig
