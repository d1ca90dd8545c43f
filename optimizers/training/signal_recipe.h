/// Recipes of signals: what a training names of the signal it asks for.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>

#include "suite/core/options.h"
#include "suite/core/problem.h"

namespace physinv {

struct StageRun;
template <class T>
class Batches;
template <class T>
class NetworkModel;
template <class T>
class Signal;

/// A number of the batches of a training's last updates, before each of them:
/// steps of constant length never settle, their average does.
struct LateError {
  std::string name;    ///< enters the content key
  double share = 0.1;  ///< of the updates, the last ones
  /// Mean over a batch, of its estimates and observations.
  std::function<double(BatchIn<double> x, BatchIn<double> y)> of;
  const char* source = __builtin_FILE();  ///< as that of Metrics

  auto fields() const {
    return std::tuple{field("late_error", name),
                      field("late_share", share),
                      implied(of, source)};
  }
};

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
  LateError late = {};
};

/// Where a signal works.
template <class T>
struct SignalPlace {
  StageRun& run;
  NetworkModel<T>& model;
  Batches<T>& batches;
  SignalOptions options;
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
  /// What products with second derivatives ask of the problem; none: the
  /// signal has no such products.
  std::optional<Needs> hessian = {}, gauss_newton = {};

  auto fields() const {
    return std::tuple{
        field("algorithm", algorithm),
        implied(gradient, jacobians, make_float, make_double, source),
        implied(hessian, gauss_newton)};
  }

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
SignalRecipe batch_signal(const std::string& algorithm,
                          Needs gradient,
                          Needs jacobians,
                          const char* source = __builtin_FILE()) {
  return {.algorithm = algorithm,
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

}  // namespace physinv
