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

class SupervisedFit final : public Stage {
 public:
  explicit SupervisedFit(const RegressionOptions& options)
      : options_(options) {}

  std::string name() const override { return "fit"; }
  Needs needs() const override { return Needs::forward | Needs::labels; }
  Options options() const override {
    Options all = {{"algorithm", "supervised"}};
    for (auto& option : describe(options_)) all.push_back(option);
    return all;
  }
  Index default_iterations() const override { return options_.iterations; }
  bool has_precision() const override { return true; }
  double operations(const CaseSize& size) const override {
    return 3 * size.predictor_operations *
           static_cast<double>(size.n * size.iterations);
  }
  Outcome run(StageRun& run) const override {
    if (run.precision == Precision::f32) return fit<float>(options_, run);
    return fit<double>(options_, run);
  }

 private:
  RegressionOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> supervised_fit(const RegressionOptions& options) {
  return std::make_shared<SupervisedFit>(options);
}

}  // namespace physinv
