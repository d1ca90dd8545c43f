#include "baselines/supervised.h"

#include "optimizers/training/predictions.h"
#include "suite/core/oracle.h"

namespace physinv {
namespace {

template <class T>
Outcome fit_predictor(const RegressionOptions& options, StageRun& run) {
  Oracle& oracle = run.oracle;
  const NetworkRole& role = run.setting.predictor;
  const Labelling& labels = run.setting.labels;
  const Samples<double>& labelled = oracle.labelled(labels.per_problem);
  NetworkModel<T> model(
      role, oracle.shape(), oracle.shape().unknowns, run.threads);
  model.initialize(run.network_init);
  Predictions<T> predict(model, run);
  const auto map = output_map<double>(run.setting, oracle);
  return fit_regression<T>(
      model,
      {.input =
           assemble<T>(role.inputs, labelled.x, labelled.given, labelled.y),
       .target =
           bounded(map->outputs_of(labelled.x), labels).template cast<T>(),
       .bounded = labels.bounded},
      options,
      run,
      [&](BatchOut<double> x) { predict(x); });
}

}  // namespace

std::shared_ptr<const Stage> supervised_fit(const RegressionOptions& options) {
  return make_stage(regression_facts("supervised",
                                     Needs::forward | Needs::labels,
                                     Networks::predictor,
                                     options),
                    [options]<class T>(StageRun& run) {
                      return fit_predictor<T>(options, run);
                    });
}

}  // namespace physinv
