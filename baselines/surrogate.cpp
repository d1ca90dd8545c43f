#include "baselines/surrogate.h"

#include "suite/core/oracle.h"

namespace physinv {
namespace {

template <class T>
Outcome fit_surrogate(const RegressionOptions& options, StageRun& run) {
  Oracle& oracle = run.oracle;
  const NetworkRole& role = run.setting.surrogate;
  const Labelling& labels = run.setting.labels;
  const Samples<double>& labelled = oracle.labelled(labels.per_problem);
  NetworkModel<T> model(
      role, oracle.shape(), oracle.shape().observations, run.threads);
  model.initialize(run.network_init);
  const Batch<double> start = oracle.start();
  Outcome out =
      fit_regression<T>(model,
                        {.input = assemble<T>(role.inputs,
                                              bounded(labelled.x, labels),
                                              labelled.given,
                                              labelled.y),
                         .target = labelled.y.template cast<T>()},
                        options,
                        run,
                        [&](BatchOut<double> x) { x = start; });
  model.save(out.arrays);
  return out;
}

}  // namespace

std::shared_ptr<const Stage> surrogate_fit(const RegressionOptions& options) {
  return make_stage(
      regression_facts(
          "surrogate", Needs::labels, Networks::surrogate, options),
      [options]<class T>(StageRun& run) {
        return fit_surrogate<T>(options, run);
      });
}

}  // namespace physinv
