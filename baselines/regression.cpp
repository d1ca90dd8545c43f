#include "baselines/regression.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "optimizers/training/first_order.h"
#include "optimizers/training/loop.h"
#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

/// Samples in a new order every pass, batch by batch.
class Passes {
 public:
  Passes(const Rng& rng, Index samples)
      : rng_(rng),
        order_(static_cast<std::size_t>(samples)),
        at_(order_.size()) {
    std::iota(order_.begin(), order_.end(), Index{0});
  }

  std::span<const Index> next(std::size_t count) {
    if (at_ + count > order_.size()) shuffle();
    at_ += count;
    return {order_.data() + at_ - count, count};
  }
  void serialize(Archive& archive) {
    const std::size_t all = order_.size();
    archive(order_, at_, pass_);
    std::vector<bool> seen(all, false);
    for (const Index i : order_)
      if (i >= 0 && static_cast<std::size_t>(i) < all)
        seen[static_cast<std::size_t>(i)] = true;
    SUITE_CHECK(order_.size() == all && at_ <= all &&
                    std::find(seen.begin(), seen.end(), false) == seen.end(),
                "the checkpoint belongs to other examples");
  }

 private:
  void shuffle() {
    Stream stream = rng_.child(pass_++).stream();
    for (std::size_t i = order_.size(); i > 1; --i) {
      const auto other = static_cast<std::size_t>(stream.uniform() * double(i));
      std::swap(order_[i - 1], order_[other]);
    }
    at_ = 0;
  }

  Rng rng_;
  std::vector<Index> order_;
  std::size_t at_;
  std::uint64_t pass_ = 0;
};

/// The signal: distance of the outputs from their targets.
template <class T>
class Labels final : public Signal<T> {
 public:
  Labels(const StageRun& run, NetworkModel<T>& model, TrainingSet<T> set)
      : probe_(run.probe),
        model_(model),
        all_(std::move(set)),
        passes_(run.batches.child("labels"), all_.target.cols()) {
    const Index count = run.oracle.count();
    in_parts_ = count < all_.target.cols();
    model_.bind(in_parts_ ? Batch<T>(all_.input.leftCols(count)) : all_.input);
    residual_.resize(all_.target.rows(), count);
    if (in_parts_) part_.resize(all_.input.rows(), count);
  }

  void warm_up() override { model_.warm_up(); }

  Vector<T>& gradient() override {
    if (in_parts_) {
      const auto some =
          passes_.next(static_cast<std::size_t>(residual_.cols()));
      for (Index j = 0; j < residual_.cols(); ++j) {
        const Index sample = some[static_cast<std::size_t>(j)];
        part_.col(j) = all_.input.col(sample);
        residual_.col(j) = -all_.target.col(sample);
      }
      residual_ += shown(model_.forward(part_));
    } else {
      residual_ = shown(model_.forward()) - all_.target;
    }
    model_.update_state();
    loss_ = residual_.template cast<double>().squaredNorm();
    probe_.trace(&loss_, sizeof(loss_));
    residual_ *= T(2);
    if (all_.bounded > 0)
      residual_.topRows(all_.bounded).array() *= T(1) - tanh_.array().square();
    return model_.backward(residual_);
  }

  void serialize(Archive& archive) override { archive(passes_, loss_); }

  void export_to(Outcome& out) const override {
    out.arrays["training_loss"] = Batch<double>::Constant(1, 1, loss_);
  }

  /// Of the first of them; nothing where every update sees all.
  void settle() {
    constexpr Index kSettled = 128;
    const Index count = std::min(kSettled, all_.input.cols());
    if (in_parts_) model_.settle(all_.input.leftCols(count));
  }

 private:
  const Batch<T>& shown(const Batch<T>& out) {
    if (all_.bounded == 0) return out;
    shown_ = out;
    tanh_ =
        out.topRows(all_.bounded).unaryExpr([](T o) { return math::tanh(o); });
    shown_.topRows(all_.bounded) = tanh_;
    return shown_;
  }

  Probe& probe_;
  NetworkModel<T>& model_;
  TrainingSet<T> all_;
  Passes passes_;
  bool in_parts_ = false;
  Batch<T> part_, residual_, shown_, tanh_;
  double loss_ = 0;
};

}  // namespace

template <class T>
Outcome fit_regression(
    NetworkModel<T>& model,
    TrainingSet<T> set,
    const RegressionOptions& options,
    StageRun& run,
    const std::function<void(BatchOut<double> x)>& estimate) {
  Labels<T> signal(run, model, std::move(set));
  FirstOrder<T> rule(options.step, model);
  Outcome out = run_training<T>({.model = model,
                                 .signal = signal,
                                 .rule = rule,
                                 .batches = nullptr,
                                 .estimate = estimate},
                                run);
  signal.settle();
  out.x.resize(run.oracle.shape().unknowns, run.oracle.count());
  estimate(out.x);
  out.arrays["weight_change"] = model.change_per_tensor(run.network_init);
  return out;
}

template decltype(fit_regression<float>) fit_regression<float>;
template decltype(fit_regression<double>) fit_regression<double>;

StageFacts regression_facts(std::string algorithm,
                            Needs needs,
                            Networks network,
                            const RegressionOptions& options,
                            const char* source) {
  Sources sources;
  add_sources(options.step, sources);
  const auto pass = network == Networks::surrogate
                        ? &CaseSize::surrogate_operations
                        : &CaseSize::predictor_operations;
  return {.name = "fit",
          .needs = needs,
          .options =
              chained({{"algorithm", std::move(algorithm)}}, describe(options)),
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
