/// What a predictor says about the case's own problems.
#pragma once

#include <memory>

#include "optimizers/network_model.h"
#include "optimizers/training/output_map.h"

namespace physinv {

/// The network asked for the case's problems, with running statistics; no part
/// of a method's counted work.
template <class T>
class Predictions {
 public:
  Predictions(NetworkModel<T>& model, const StageRun& run);
  void operator()(BatchOut<double> x);

 private:
  NetworkModel<T>& model_;
  const Oracle& oracle_;
  std::unique_ptr<OutputMap<double>> map_;
  Batch<T> query_, output_;
};

extern template class Predictions<float>;
extern template class Predictions<double>;

}  // namespace physinv
