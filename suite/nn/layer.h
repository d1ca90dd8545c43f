/// A layer: a pure function on rows, and its reverse.
///
/// A layer owns no numbers. Parameters, state, tape slots and scratch come
/// with each call, so one object serves any number of threads and vectors.
///
/// How more fits in without touching what is there:
///  - Fields: between `field_input` and `flatten` rows are [position][channel]
///    (window.h); everything element-wise works as it is.
///  - Composite layers own inner layers as a `Chain` (chain.h).
///  - Forward mode and its reverse: `tangent` and `backward_tangent`, with
///    defaults that report the lack; they read the same tape and keep what they
///    share on one of their own, slot by slot its derivative. A layer that
///    is linear says so by its base class (piecewise_linear.h).
///  - Stacked Jacobians of more layer kinds: `add_rows`; the cotangents
///    walking down are those of `backward`, run on each sample's rows at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "suite/core/check.h"
#include "suite/core/network.h"
#include "suite/core/threads.h"
#include "suite/nn/kinds.h"
#include "suite/nn/layer_rows.h"
#include "suite/nn/rows.h"

namespace physinv::nn {

/// What a layer uses in addition to its input and output: where its numbers
/// are, and what a pass has left on the tape.
template <class T>
struct Replay {
  const T* parameters = nullptr;  ///< this layer's part of the flat vector
  const Tape* tape = nullptr;
  std::size_t slot = 0;  ///< first of this layer's `slots()` tape slots
  Workspace* work = nullptr;
  bool training = false;
  /// The first `leading` and last `trailing` input rows are constant over the
  /// batch; a layer may fold them or ignore this.
  Index leading = 0, trailing = 0;
};

/// The same in the pass that fills the tape.
template <class T>
struct Run : Replay<T> {
  Run(const Replay<T>& at, Tape& fills, const T* reads)
      : Replay<T>(at), tape(&fills), state(reads) {
    Replay<T>::tape = tape;
  }
  Tape* tape;
  const T* state;  ///< this layer's part
};

/// The activation in front of a layer: its derivative at the stored output
/// multiplies the cotangent on its way down.
template <class T>
struct Gate {
  Activation activation = Activation::identity;
  Rows<const T> y = {};
};

/// One layer's step back. y_bar already carries the derivative of the
/// activation the layer has taken in; x_bar leaves with that of `gate`.
template <class T>
struct Backward {
  Rows<const T> x, y, y_bar;
  T* parameters_bar = nullptr;  ///< overwritten; null: not wanted
  Rows<T> x_bar = {};           ///< overwritten; null: not wanted
  Gate<T> gate = {};
};

/// One layer's step of forward mode: y_dot = dy/dx x_dot + dy/dp
/// parameters_dot, the activation taken in included. Padding lanes of x_dot
/// are finite.
template <class T>
struct Tangent {
  Rows<const T> x, y, x_dot;
  Rows<T> y_dot = {};
  const T* parameters_dot = nullptr;  ///< the direction
  Tape* dots = nullptr;               ///< derivatives of the tape's slots
};

/// One layer's step back and its derivative along the direction of the last
/// tangent. As in `Backward`, but x_bar and x_bar_dot leave without the
/// derivative of any gate.
template <class T>
struct BackwardTangent {
  Rows<const T> x, y, x_dot, y_dot, y_bar, y_bar_dot;
  const T* parameters_dot = nullptr;  ///< the direction
  const Tape* dots = nullptr;         ///< as `tangent` left them
  T* parameters_bar = nullptr;        ///< overwritten; null: not wanted
  T* parameters_bar_dot = nullptr;    ///< overwritten; there as soon as tensors
  Rows<T> x_bar = {}, x_bar_dot = {};  ///< overwritten; null: not wanted

  Backward<T> base() const {
    return {.x = x,
            .y = y,
            .y_bar = y_bar,
            .parameters_bar = parameters_bar,
            .x_bar = x_bar};
  }
  /// The same step with the derivative's cotangents.
  Backward<T> base_dot() const {
    return {.x = x,
            .y = y,
            .y_bar = y_bar_dot,
            .parameters_bar = parameters_bar_dot,
            .x_bar = x_bar_dot};
  }
};

/// f(begin, end) on blocks of `count` rows or positions, of `numbers` each,
/// over the threads: for passes that store every number once, so that no bit
/// depends on the blocks.
template <class T, class F>
void for_rows(const Replay<T>& at, Index count, Index numbers, F&& f) {
  constexpr Index kNumbers = 16384;  // some 10 us
  const Index some = std::max<Index>(1, kNumbers / numbers);
  for_blocks(
      at.work->threads(), (count + some - 1) / some, [&](Index block, int) {
        f(block * some, std::min((block + 1) * some, count));
      });
}

template <class T>
class Layer {
 public:
  Layer(Index inputs, Index outputs) : inputs_(inputs), outputs_(outputs) {}
  virtual ~Layer() = default;

  Index inputs() const { return inputs_; }
  Index outputs() const { return outputs_; }

  /// Tensors in the order they lie in memory; kind, size and fan_in are set.
  virtual std::vector<TensorInfo> tensors() const { return {}; }
  virtual Index state_count() const { return 0; }
  virtual void initialize_state(T* /*state*/) const {}
  /// Tape slots it needs in addition to its input and output.
  virtual std::size_t slots() const { return 0; }

  /// Whether `backward`, `tangent` and its reverse read y. If not, a layer
  /// around this one need not keep it.
  virtual bool reads_output() const { return true; }
  /// Not null if the layer is nothing but this activation.
  virtual const Activation* pure_activation() const { return nullptr; }
  /// Takes a following activation into its own store, if it can.
  virtual bool fuse(Activation) { return false; }
  /// Whether it makes use of `Replay::leading` and `trailing`.
  virtual bool folds_constants() const { return false; }
  /// The activation taken in.
  virtual Activation fused() const { return Activation::identity; }

  virtual void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const = 0;
  virtual void backward(const Replay<T>& at, const Backward<T>& b) const = 0;
  virtual void tangent(const Replay<T>& /*at*/, const Tangent<T>& /*t*/) const {
    SUITE_CHECK(false, "this layer has no forward mode");
  }
  virtual void backward_tangent(const Replay<T>& /*at*/,
                                const BackwardTangent<T>& /*b*/) const {
    SUITE_CHECK(false, "this layer has no products with its Hessian");
  }
  /// Appends its columns of a stacked Jacobian: see RowJacobian. x
  /// has the samples, y_bar the rows.
  virtual void add_rows(Rows<const T> /*x*/,
                        Rows<const T> /*y_bar*/,
                        Index /*offset*/,
                        std::vector<LayerRows<T>>&) const {
    SUITE_CHECK(tensors().empty(),
                "this layer cannot compute its Jacobian by rows");
  }
  /// Network::evaluate_plainly of this layer, y of the right size.
  virtual bool evaluate_plainly(const double* /*parameters*/,
                                const Vector<double>& /*x*/,
                                Vector<double>& /*y*/) const {
    return false;
  }
  /// Folds the last training pass's statistics into this layer's state.
  virtual void update_state(const Tape& /*tape*/,
                            std::size_t /*slot*/,
                            T* /*state*/) const {}
  /// Floating-point operations of one sample, forward.
  virtual double operations() const { return static_cast<double>(outputs_); }

 private:
  Index inputs_, outputs_;
};

template <class T>
using LayerPointer = std::unique_ptr<Layer<T>>;
template <class T>
using Layers = std::vector<LayerPointer<T>>;

}  // namespace physinv::nn
