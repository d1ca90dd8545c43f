/// Layers one after the other: the implementation of `Network`.
///
/// At construction an activation behind a layer that can take it in is fused
/// into that layer's store; its derivative is then multiplied in the store of
/// the next layer's input gradient. The tape holds each layer's output, once.
///
/// Bits: without batch statistics and `Pass::fixed_input`, a sample's output
/// and input gradient depend on that sample alone, not on the batch it is in.
/// Nothing ever depends on the number of threads.
#pragma once

#include <memory>
#include <vector>

#include "suite/core/network.h"
#include "suite/nn/layer.h"
#include "suite/nn/layer_rows.h"

namespace physinv::nn {

template <class T>
class Sequential final : public Network<T>, public RowJacobian<T> {
 public:
  using Layers = std::vector<std::unique_ptr<Layer<T>>>;

  /// Sizes must fit each other; at least one layer.
  explicit Sequential(Layers layers, Init init = Init::fan_in);

  Index inputs() const override { return layers_.front()->inputs(); }
  Index outputs() const override { return layers_.back()->outputs(); }
  Index parameter_count() const override { return parameter_count_; }
  Index state_count() const override { return state_count_; }
  const std::vector<TensorInfo>& tensors() const override { return tensors_; }

  /// As `Init` says, in double, then rounded.
  /// Each tensor draws from the child of its own name.
  void initialize(const Rng& rng,
                  VectorOut<T> parameters,
                  VectorOut<T> state) const override;
  void forward(VectorIn<T> parameters,
               VectorIn<T> state,
               BatchIn<T> in,
               BatchOut<T> out,
               Tape& tape,
               Workspace& work,
               Pass pass = {}) const override;
  void backward(VectorIn<T> parameters,
                const Tape& tape,
                BatchIn<T> out_bar,
                VectorOut<T>* parameters_bar,
                BatchOut<T>* in_bar,
                Workspace& work) const override;
  void tangent(VectorIn<T> parameters,
               const Tape& tape,
               VectorIn<T> parameters_dot,
               BatchIn<T> in_dot,
               BatchOut<T> out_dot,
               Tape& dots,
               Workspace& work) const override;
  void backward_tangent(VectorIn<T> parameters,
                        const Tape& tape,
                        VectorIn<T> parameters_dot,
                        const Tape& dots,
                        BatchIn<T> out_bar,
                        BatchIn<T> out_bar_dot,
                        VectorOut<T>* parameters_bar,
                        VectorOut<T> parameters_bar_dot,
                        Workspace& work) const override;
  void jacobian_rows(VectorIn<T> parameters,
                     const Tape& tape,
                     BatchIn<T> out_bar,
                     std::vector<LayerRows<T>>& layers,
                     Workspace& work) const override;
  void update_state(const Tape& tape, VectorOut<T> state) const override;
  bool evaluate_plainly(VectorIn<double> parameters,
                        VectorIn<double> in,
                        Vector<double>& out) const override;
  double operations() const override;

 private:
  /// Where a layer's numbers are.
  struct Place {
    Index parameters = 0, state = 0;
    std::size_t slot = 0;
  };
  struct Header;

  void place_layers();
  LayerArgs<T> args(std::size_t layer,
                    const Header& header,
                    Tape& tape,
                    Workspace& work) const;
  LayerArgs<T> tangent_args(std::size_t layer,
                            const Header& header,
                            VectorIn<T> parameters,
                            const Tape& tape,
                            VectorIn<T> parameters_dot,
                            const Tape& dots,
                            Workspace& work) const;
  void run_prefix(BatchIn<T> in,
                  const Header& header,
                  Tape& tape,
                  Workspace& work) const;
  /// Input of layer i on the tape; that of layer size() is the output.
  Lanes<T> features(const Tape& tape, std::size_t i, Index samples) const;
  Lanes<T> open(Tape& tape, std::size_t i, Index samples) const;

  Layers layers_;
  Init init_;
  std::vector<Place> places_;
  std::vector<TensorInfo> tensors_;
  Index parameter_count_ = 0, state_count_ = 0;
  std::size_t prefix_ = 0;  ///< leading layers without parameters or state
  Index widest_ = 0;
};

extern template class Sequential<float>;
extern template class Sequential<double>;

}  // namespace physinv::nn
