/// Signals of minibatches that push the estimates: the network's outputs become
/// estimates x, what pushes x goes back through the map and the network. A
/// signal of this kind says no more than `push`.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "optimizers/training/batches.h"
#include "optimizers/training/output_map.h"
#include "optimizers/training/signal.h"

namespace physinv {

struct SignalOptions {
  /// x_bar_i = gradient_scale / batch * d objective_i / dx_i: 1 is the batch's
  /// mean.
  double gradient_scale = 1;
  /// Samples that are on the tapes at once, 0: the batch. Saves memory; the
  /// gradient differs by rounding.
  Index chunk = 0;
  /// Jacobians come with a projected g, if the problem can: the same update of
  /// half-inverse rules but for rounding.
  bool project = true;
};

/// Where a signal works.
template <class T>
struct SignalPlace {
  StageRun& run;
  NetworkModel<T>& model;
  Batches<T>& batches;
  SignalOptions options;
};

/// Leaves `batch_loss` (1 x updates): mean before the update.
template <class T>
class BatchSignal : public Signal<T> {
 public:
  explicit BatchSignal(const SignalPlace<T>& place);

  Vector<T>& gradient() override;
  void leave(Outcome& out) const override;
  std::size_t bytes() const override;

 protected:
  /// x_bar = factor * d objective / d x and the losses of samples `first`,
  /// first+1 .. of the batch, for as many as x has columns.
  virtual void push(BatchIn<T> x,
                    Index first,
                    VectorOut<double> loss,
                    BatchOut<T> x_bar) = 0;

  /// Estimates for samples first .. first+count-1, in training mode.
  const Batch<T>& estimate(Index first, Index count);
  void note_loss() { losses_.push_back(loss_.mean()); }

  StageRun& run_;
  NetworkModel<T>& model_;
  Batches<T>& batches_;
  SignalOptions options_;
  T factor_;
  std::unique_ptr<OutputMap<T>> map_;
  Vector<double> loss_;

 private:
  Vector<T>& gradient_of(Index first, Index count);

  Batch<T> x_, x_bar_;
  Vector<T> sum_;
  std::vector<double> losses_;
};

/// Makes a signal in either precision.
struct SignalRecipe {
  std::string algorithm;      ///< for the record
  Needs gradient, jacobians;  ///< what either asks of the problem
  template <class T>
  using Make =
      std::function<std::unique_ptr<Signal<T>>(const SignalPlace<T>& place)>;
  Make<float> make_float;
  Make<double> make_double;
  const char* source;  ///< where it is written

  template <class T>
  std::unique_ptr<Signal<T>> make(const SignalPlace<T>& place) const {
    if constexpr (std::is_same_v<T, float>) {
      return make_float(place);
    } else {
      return make_double(place);
    }
  }
};

/// batch_signal<Proxy>("sip", Needs::inverse, Needs::inverse)
template <template <class> class S>
SignalRecipe batch_signal(std::string algorithm,
                          Needs gradient,
                          Needs jacobians,
                          const char* source = __builtin_FILE()) {
  return {.algorithm = std::move(algorithm),
          .gradient = gradient,
          .jacobians = jacobians,
          .make_float =
              [](const SignalPlace<float>& place) {
                return std::make_unique<S<float>>(place);
              },
          .make_double =
              [](const SignalPlace<double>& place) {
                return std::make_unique<S<double>>(place);
              },
          .source = source};
}

extern template class BatchSignal<float>;
extern template class BatchSignal<double>;

}  // namespace physinv
