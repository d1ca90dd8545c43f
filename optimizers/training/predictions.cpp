#include "optimizers/training/predictions.h"

#include "suite/core/oracle.h"

namespace physinv {

template <class T>
Predictions<T>::Predictions(NetworkModel<T>& model, const StageRun& run)
    : model_(model),
      oracle_(run.oracle),
      map_(output_map<double>(run.setting, oracle_)),
      query_(assemble<T>(run.setting.predictor.inputs,
                         oracle_.start(),
                         oracle_.given(),
                         oracle_.observations())),
      output_(oracle_.shape().unknowns, oracle_.count()) {}

template <class T>
void Predictions<T>::operator()(BatchOut<double> x) {
  model_.predict(query_, output_);
  (*map_)(output_.template cast<double>(), oracle_.observations(), x);
}

template class Predictions<float>;
template class Predictions<double>;

}  // namespace physinv
