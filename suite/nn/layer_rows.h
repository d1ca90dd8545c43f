/// The stacked Jacobian of a network by its layers, without the Jacobian: what
/// half-inverse gradients need of a network in addition to its gradients.
#pragma once

#include <vector>

#include "suite/core/network.h"

namespace physinv {

/// One layer's columns of a stacked Jacobian. Row r belongs to sample
/// r / per_sample; its entries are b_r (outer) a_sample, outputs x inputs, then
/// b_r, added up over the positions of a convolution. Features are rows of
/// memory, samples contiguous.
template <class T>
struct LayerRows {
  Index offset;           ///< of the layer's parameters
  Index inputs, outputs;  ///< features of a and b, at one position
  const T* a;             ///< inputs x samples
  Index a_stride;
  const T* b;  ///< outputs x rows
  Index b_stride;
  Index positions = 1;           ///< of a convolution
  Index a_step = 0, b_step = 0;  ///< features from a position to the next
  /// Input i = tap (inputs / taps) + channel has the weight channel taps + tap
  /// of its output.
  Index taps = 1;

  /// Of the Jacobian: weights and biases.
  Index columns() const { return (inputs + 1) * outputs; }
  /// Place of the weight from input i to output o, from `offset` on.
  Index weight(Index i, Index o) const {
    const Index channels = inputs / taps;
    return o * inputs + i % channels * taps + i / channels;
  }
};

template <class T>
class RowJacobian {
 public:
  virtual ~RowJacobian() = default;

  /// The Jacobian of several functions of each sample's output, at the last
  /// forward pass on this tape: columns [i * per_sample, (i + 1) * per_sample)
  /// of `out_bar` are the cotangents of sample i's functions. Appends its
  /// layers from the last to the first; their arrays live on the tape and in
  /// `work`, until the scope there ends. Layers that are neither dense nor
  /// convolutions without padding refuse.
  virtual void jacobian_rows(VectorIn<T> parameters,
                             const Tape& tape,
                             BatchIn<T> out_bar,
                             std::vector<LayerRows<T>>& layers,
                             Workspace& work) const = 0;
};

/// The network as one that gives its Jacobian by rows.
template <class T>
const RowJacobian<T>& by_rows(const Network<T>& network) {
  const auto* rows = dynamic_cast<const RowJacobian<T>*>(&network);
  SUITE_CHECK(rows != nullptr,
              "this network cannot compute its Jacobian by rows");
  return *rows;
}

}  // namespace physinv
