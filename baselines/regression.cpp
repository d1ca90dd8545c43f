#include "baselines/regression.h"

#include "optimizers/training/first_order.h"
#include "optimizers/training/loop.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

/// The signal: distance of the outputs from their targets.
template <class T>
class Labels final : public Signal<T> {
 public:
  Labels(const Probe& probe, NetworkModel<T>& model, Batch<T> target)
      : probe_(probe),
        model_(model),
        target_(std::move(target)),
        residual_(target_.rows(), target_.cols()) {}

  void warm_up() override { model_.warm_up(); }

  Vector<T>& gradient() override {
    residual_.noalias() = model_.forward() - target_;
    model_.update_state();
    loss_ = residual_.template cast<double>().squaredNorm();
    probe_.trace(&loss_, sizeof(loss_));
    residual_ *= T(2);
    return model_.backward(residual_);
  }

  void leave(Outcome& out) const override {
    out.arrays["training_loss"] = Batch<double>::Constant(1, 1, loss_);
  }

 private:
  const Probe& probe_;
  NetworkModel<T>& model_;
  Batch<T> target_, residual_;
  double loss_ = 0;
};

}  // namespace

template <class T>
Outcome fit_regression(
    NetworkModel<T>& model,
    Batch<T> target,
    const RegressionOptions& options,
    StageRun& run,
    const std::function<void(BatchOut<double> x)>& estimate) {
  Labels<T> signal(run.probe, model, std::move(target));
  FirstOrder<T> rule(options.step, model);
  Outcome out = run_training<T>({.model = model,
                                 .signal = signal,
                                 .rule = rule,
                                 .batches = nullptr,
                                 .estimate = estimate},
                                run);
  out.x.resize(run.oracle.shape().unknowns, run.oracle.count());
  estimate(out.x);
  out.arrays["weight_change"] = model.change_per_tensor(run.network_init);
  return out;
}

template Outcome fit_regression(NetworkModel<float>&,
                                Batch<float>,
                                const RegressionOptions&,
                                StageRun&,
                                const std::function<void(BatchOut<double>)>&);
template Outcome fit_regression(NetworkModel<double>&,
                                Batch<double>,
                                const RegressionOptions&,
                                StageRun&,
                                const std::function<void(BatchOut<double>)>&);

StageFacts regression_facts(std::string algorithm,
                            Needs needs,
                            Networks network,
                            const RegressionOptions& options,
                            const char* source) {
  Options all = {{"algorithm", std::move(algorithm)}};
  for (auto& option : describe(options.step)) all.push_back(option);
  Sources sources;
  add_sources(options.step, sources);
  const auto pass = network == Networks::surrogate
                        ? &CaseSize::surrogate_operations
                        : &CaseSize::predictor_operations;
  return {.name = "fit",
          .needs = needs,
          .options = std::move(all),
          .iterations = options.iterations,
          .networks = network,
          .operations =
              [pass](const CaseSize& size) {
                return 3 * (size.*pass) *
                       static_cast<double>(size.n * size.iterations);
              },
          .sources = std::move(sources),
          .source = source};
}

}  // namespace physinv
