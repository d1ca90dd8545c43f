#include "optimizers/training/update_cosine.h"

#include "optimizers/metrics.h"
#include "optimizers/training/batches.h"
#include "optimizers/training/output_map.h"
#include "optimizers/training/signal.h"
#include "suite/core/check.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

double cosine(const Vector<double>& a, const Vector<double>& b) {
  const double lengths = a.norm() * b.norm();
  return lengths == 0 ? 0 : a.dot(b) / lengths;
}

template <class T>
class WatchedProxy final : public Signal<T> {
 public:
  WatchedProxy(const SignalRecipe& proxy, const SignalPlace<T>& place)
      : run_(place.run),
        model_(place.model),
        batches_(place.batches),
        proxy_(proxy.make<T>(place)),
        inverse_(dynamic_cast<const Inverse<double>&>(run_.oracle.inspect())),
        map_(output_map<T>(run_.setting, run_.oracle)),
        work_(run_.threads) {
    batches_.keep_exact();
  }

  void warm_up() override { proxy_->warm_up(); }
  bool evaluate(bool last) override {
    if (waits()) look_behind();
    return proxy_->evaluate(last);
  }
  Vector<T>& gradient() override {
    const Index update = run_.probe.iteration() - 1;
    if (update >= next_) {
      next_ = next_measured(update);
      look_ahead();
    }
    return proxy_->gradient();
  }

  void serialize(Archive& archive) override {
    archive(*proxy_, input_, target_, before_, wanted_, cosines_, next_);
    const Index unknowns = run_.oracle.shape().unknowns;
    SUITE_CHECK(
        !waits() || (input_.cols() == batches_.size() &&
                     target_.cols() == batches_.size() &&
                     before_.size() == unknowns && wanted_.size() == unknowns),
        "the checkpoint belongs to other batches");
  }
  void export_to(Outcome& out) const override {
    proxy_->export_to(out);
    out.arrays["update_cosine"] = as_row(cosines_);
  }
  Counts counts() const override { return proxy_->counts(); }
  std::size_t bytes() const override {
    return proxy_->bytes() + work_.bytes() +
           static_cast<std::size_t>(input_.size() + target_.size() +
                                    x_.size()) *
               sizeof(T);
  }

 private:
  bool waits() const { return input_.cols() > 0; }

  void look_ahead() {
    const Probe::Aside aside = run_.probe.measuring();
    const Index n = batches_.size();
    input_ = batches_.input(0, n), target_ = batches_.target(0, n);
    before_ = mean_estimate();
    Batch<double> there(x_.rows(), n);
    inverse_.invert({x_.template cast<double>(),
                     batches_.given(0, n).template cast<double>()},
                    batches_.exact_target(0, n),
                    there,
                    work_);
    wanted_ = there.rowwise().mean() - before_;
  }

  void look_behind() {
    const Probe::Aside aside = run_.probe.measuring();
    cosines_.push_back(cosine(mean_estimate() - before_, wanted_));
    input_.resize(input_.rows(), 0);
  }

  Vector<double> mean_estimate() {
    const Batch<T>& out = model_.forward(input_);
    x_.resizeLike(out);
    (*map_)(out, target_, x_);
    return x_.template cast<double>().rowwise().mean();
  }

  StageRun& run_;
  NetworkModel<T>& model_;
  Batches<T>& batches_;
  std::unique_ptr<Signal<T>> proxy_;
  const Inverse<double>& inverse_;
  std::unique_ptr<OutputMap<T>> map_;
  Workspace work_;
  Batch<T> input_, target_;  ///< of the update that is looked at, if any
  Batch<T> x_;
  Vector<double> before_, wanted_;
  std::vector<double> cosines_;
  Index next_ = 0;
};

template <class T>
SignalRecipe::Make<T> watched(const SignalRecipe& proxy) {
  return [proxy](const SignalPlace<T>& place) {
    return std::make_unique<WatchedProxy<T>>(proxy, place);
  };
}

}  // namespace

SignalRecipe proxy_with_cosines(ProxyNorm norm, ProxyPrecision precision) {
  const SignalRecipe proxy = inverse_proxy(norm, precision);
  return {.algorithm = proxy.algorithm + ", cosines of updates",
          .gradient = proxy.gradient,
          .jacobians = proxy.jacobians,
          .make_float = watched<float>(proxy),
          .make_double = watched<double>(proxy),
          .source = __builtin_FILE()};
}

}  // namespace physinv
