/// A network as a pure function of (parameters, state, input, tape).
///
/// Parameters are one flat vector owned by the caller, so that Adam, BFGS and
/// half-inverse gradients treat weights like any unknown. Running statistics
/// are a second flat vector, `state`, written only by `update_state`.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/rng.h"
#include "suite/core/workspace.h"

namespace physinv {

/// One tensor inside the flat parameter vector.
struct TensorInfo {
  std::string name;  ///< kind and number as in the paper's figures: m1, b1, k1
  char kind = 'm';   ///< m matrix, k kernel, b bias, s scale, o offset, f modes
  Index offset = 0, size = 0;
  Index fan_in = 0;   ///< inputs x taps of the layer
  Index fan_out = 0;  ///< outputs x taps
  /// Drawn from U[0, up_to) whatever the network's rule, where that is not 0.
  double up_to = 0;
};

/// How a pass is to be run.
struct Pass {
  bool training = false;  ///< batch statistics instead of running ones
  /// The input equals that of the last forward pass on this tape: layers in
  /// front of the first parameter are not run again.
  bool same_input = false;
  /// This input will be used for many passes: features that are constant over
  /// the batch are folded into the first layer's bias, also in the backward
  /// pass. Differs from the full computation by rounding only.
  bool fixed_input = false;
};

template <class T>
class Network {
 public:
  virtual ~Network() = default;

  virtual Index inputs() const = 0;
  virtual Index outputs() const = 0;
  virtual Index parameter_count() const = 0;
  virtual Index state_count() const = 0;
  virtual const std::vector<TensorInfo>& tensors() const = 0;

  /// Draws initial parameters (in double, rounded) and the initial state.
  virtual void initialize(const Rng& rng,
                          VectorOut<T> parameters,
                          VectorOut<T> state) const = 0;

  /// out = N(in). The tape keeps what backward needs; batches of different
  /// sizes may use the same tape one after the other.
  virtual void forward(VectorIn<T> parameters,
                       VectorIn<T> state,
                       BatchIn<T> in,
                       BatchOut<T> out,
                       Tape& tape,
                       Workspace& work,
                       Pass pass = {}) const = 0;

  /// Gradient at the last forward pass on this tape. A null pointer asks for
  /// nothing and costs nothing. `parameters_bar` is overwritten.
  virtual void backward(VectorIn<T> parameters,
                        const Tape& tape,
                        BatchIn<T> out_bar,
                        VectorOut<T>* parameters_bar,
                        BatchOut<T>* in_bar,
                        Workspace& work) const = 0;

  /// Forward mode: the derivative of the output along parameters_dot and in_dot
  /// (without columns: zero), at the last forward pass on `tape`. The tape
  /// stays as it is, for any number of directions; each slot of `dots` gets the
  /// derivative of the tape's. Counted as a forward pass.
  virtual void tangent(VectorIn<T> parameters,
                       const Tape& tape,
                       VectorIn<T> parameters_dot,
                       BatchIn<T> in_dot,
                       BatchOut<T> out_dot,
                       Tape& dots,
                       Workspace& work) const;

  /// `backward` by the parameters (unless null) and its derivative along the
  /// direction of the last `tangent` on `dots`, along which out_bar has the
  /// derivative out_bar_dot: a product with the Hessian. Counted as two
  /// backward passes.
  virtual void backward_tangent(VectorIn<T> parameters,
                                const Tape& tape,
                                VectorIn<T> parameters_dot,
                                const Tape& dots,
                                BatchIn<T> out_bar,
                                BatchIn<T> out_bar_dot,
                                VectorOut<T>* parameters_bar,
                                VectorOut<T> parameters_bar_dot,
                                Workspace& work) const;

  /// One sample by plain loops in double, which share nothing with `forward`:
  /// for checks of what was recorded. False where a layer has no such loops.
  virtual bool evaluate_plainly(VectorIn<double> /*parameters*/,
                                VectorIn<double> /*in*/,
                                Vector<double>& /*out*/) const {
    return false;
  }

  /// Folds the batch statistics of the last training pass into the state.
  virtual void update_state(const Tape& tape, VectorOut<T> state) const = 0;

  /// Rough floating-point operations of one forward pass of one sample.
  virtual double operations() const = 0;
};

template <class T>
void Network<T>::tangent(VectorIn<T>,
                         const Tape&,
                         VectorIn<T>,
                         BatchIn<T>,
                         BatchOut<T>,
                         Tape&,
                         Workspace&) const {
  SUITE_CHECK(false, "this network has no forward mode");
}

template <class T>
void Network<T>::backward_tangent(VectorIn<T>,
                                  const Tape&,
                                  VectorIn<T>,
                                  const Tape&,
                                  BatchIn<T>,
                                  BatchIn<T>,
                                  VectorOut<T>*,
                                  VectorOut<T>,
                                  Workspace&) const {
  SUITE_CHECK(false, "this network has no products with its Hessian");
}

/// Lines `#include` (file, header) that options leave without effect: layers
/// that a network does not have, rules that a stage does not take.
using UnusedIncludes = std::vector<std::pair<std::string, std::string>>;

/// Makes one network of one configuration, in float and in double.
struct NetworkRecipe {
  std::string description;  ///< enters the record and the content key
  std::function<std::unique_ptr<Network<float>>(Index inputs, Index outputs)>
      make_float;
  std::function<std::unique_ptr<Network<double>>(Index inputs, Index outputs)>
      make_double;
  const char* source = __builtin_FILE();  ///< where the recipe is written
  UnusedIncludes unused = {};

  template <class T>
  std::unique_ptr<Network<T>> make(Index inputs, Index outputs) const {
    if constexpr (std::is_same_v<T, float>) {
      return make_float(inputs, outputs);
    } else {
      return make_double(inputs, outputs);
    }
  }
};

}  // namespace physinv
