#include "baselines/supervised.h"

namespace physinv {
namespace {

template <class T>
Outcome fit(const RegressionOptions& options, StageRun& run) {
  Oracle& oracle = run.oracle;
  const Setting& setting = run.setting;
  const auto& fields = setting.predictor.inputs;
  const Samples<double>& labelled = oracle.labelled();
  const Batch<double> start = oracle.start();
  const Index unknowns = oracle.shape().unknowns;

  NetworkModel<T> model(
      setting.predictor, oracle.shape(), unknowns, run.threads);
  model.initialize(run.network_init);
  model.bind(assemble<T>(fields, labelled.x, labelled.given, labelled.y));
  const Batch<T> target =
      ((labelled.x - start) / setting.output_scale).template cast<T>();

  const Batch<T> query =
      assemble<T>(fields, start, oracle.given(), oracle.observations());
  Batch<T> output(unknowns, oracle.count());
  const auto predict = [&](BatchOut<double> x) {
    model.predict(query, output);
    x = start + setting.output_scale * output.template cast<double>();
  };
  const double loss = fit_regression<T>(model, target, options, run, predict);

  Outcome out = regression_outcome(model, loss, run);
  out.x.resizeLike(start);
  predict(out.x);
  return out;
}

}  // namespace

std::shared_ptr<const Stage> supervised_fit(const RegressionOptions& options) {
  return regression_stage({.algorithm = "supervised",
                           .needs = Needs::forward | Needs::labels,
                           .operations = &CaseSize::predictor_operations,
                           .in_float = fit<float>,
                           .in_double = fit<double>},
                          options);
}

}  // namespace physinv
