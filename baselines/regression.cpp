#include "baselines/regression.h"

namespace physinv {
namespace {

class RegressionStage final : public Stage {
 public:
  RegressionStage(const RegressionFit& fit, const RegressionOptions& options)
      : fit_(fit), options_(options) {}

  std::string name() const override { return "fit"; }
  Needs needs() const override { return fit_.needs; }
  Options options() const override {
    Options all = {{"algorithm", fit_.algorithm}};
    for (auto& option : describe(options_.step)) all.push_back(option);
    return all;
  }
  Index default_iterations() const override { return options_.iterations; }
  bool has_precision() const override { return true; }
  double operations(const CaseSize& size) const override {
    return 3 * (size.*fit_.operations) *
           static_cast<double>(size.n * size.iterations);
  }
  Outcome run(StageRun& run) const override {
    const bool single = run.precision == Precision::f32;
    return (single ? fit_.in_float : fit_.in_double)(options_, run);
  }

 private:
  RegressionFit fit_;
  RegressionOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> regression_stage(
    const RegressionFit& fit, const RegressionOptions& options) {
  return std::make_shared<RegressionStage>(fit, options);
}

}  // namespace physinv
