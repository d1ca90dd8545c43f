/// One update of a network's parameters by a power of the stacked Jacobian of
/// network and solver together (half-inverse gradients paper, Eq. 6):
///
///   theta -= rate * s_max^beta J^(kappa, tau) g,   J = S N
///
/// S_i the solver's Jacobian of sample i, N_i the network's, g = dLoss/dy
/// stacked. A wide J (more parameters than rows) is never formed: its rows are
/// outer products, and J J^T is enough (optimizers/half_inverse). A tall one
/// is small, and is taken apart as it is. Counted are, in the workspace, the
/// decompositions given up for a more exact one (`abandoned_levels`) and the
/// updates that were accurate enough without one (`skipped_levels`).
#pragma once

#include <vector>

#include "optimizers/half_inverse/half_inverse.h"
#include "optimizers/half_inverse/shared_functions.h"
#include "optimizers/half_inverse/structured_gram.h"
#include "optimizers/half_inverse/tall_power.h"
#include "suite/core/network.h"
#include "suite/core/options.h"
#include "suite/core/recipe.h"

namespace physinv {

template <class T>
class HalfInverseStep {
 public:
  explicit HalfInverseStep(const HalfInverseStepOptions& options,
                           Threads* threads = nullptr)
      : options_(options), power_(options.numerics, threads) {}

  /// At the last forward pass on `tape`. Column i of `solver` is S_i
  /// (observations x unknowns, column-major), of `g` the gradient by sample
  /// i's observations. False, and nothing changed, if the update is not
  /// finite.
  bool operator()(const Network<T>& network,
                  VectorOut<T> parameters,
                  const Tape& tape,
                  BatchIn<T> solver,
                  BatchIn<T> g,
                  Workspace& work);

  /// The last update, without the rate, and what is known about it.
  const Batch<double>& update() const { return update_; }
  const hig::HalfInverseReport& report() const { return report_; }
  std::size_t bytes() const;

 private:
  void power_of_gram(const Network<T>& network,
                     VectorIn<T> parameters,
                     const Tape& tape,
                     Index samples,
                     Workspace& work);
  void power_of_jacobian(VectorIn<T> parameters, Index samples);

  HalfInverseStepOptions options_;
  hig::HalfInverse power_;
  hig::SharedFunctions shared_;
  hig::TallPower tall_;
  linalg::TallColumns columns_;
  hig::StructuredGram form_gram_;
  hig::HalfInverseReport report_;
  std::vector<LayerRows<T>> layers_;
  Batch<T> rows_, out_bar_;
  Batch<double> gram_, update_;
  Vector<double> g_, reordered_;
  Vector<T> column_;
};

extern template class HalfInverseStep<float>;
extern template class HalfInverseStep<double>;

}  // namespace physinv
