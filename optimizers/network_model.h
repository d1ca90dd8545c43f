/// A network in its place: assembled inputs, parameters, and the buffers that
/// training and prediction need. Nothing allocates after the first step.
#pragma once

#include <memory>
#include <string>

#include "suite/core/method.h"

namespace physinv {

/// Stacks the fields of a role: one input column per sample.
template <class T>
Batch<T> assemble(const std::vector<Field>& fields,
                  const Batch<double>& x,
                  const Batch<double>& given,
                  const Batch<double>& y);

/// Unknowns as networks learn and read them (Labelling::bounded).
Batch<double> bounded(Batch<double> x, const Labelling& labels);

/// Rows a role reads.
Index input_rows(const std::vector<Field>& fields, const Shape& shape);

template <class T>
class NetworkModel {
 public:
  NetworkModel(const NetworkRole& role,
               const Shape& shape,
               Index outputs,
               Threads* threads);

  const Network<T>& network() const { return *network_; }

  void initialize(const Rng& rng);
  /// Parameters and running statistics as an earlier stage left them.
  void load(const Arrays& arrays);
  void save(Arrays& arrays) const;

  /// The samples every training pass runs on.
  void bind(Batch<T> input);
  /// Outputs for the bound input, in training mode.
  const Batch<T>& forward();
  /// Outputs for a minibatch, in training mode.
  const Batch<T>& forward(BatchIn<T> input);
  /// Gradient of the parameters for cotangents of the last `forward`; its
  /// memory is the caller's until the next call.
  Vector<T>& backward(BatchIn<T> out_bar);
  /// Derivative of the last `forward`'s outputs where the parameters move along
  /// `direction`: for any number of directions.
  const Batch<T>& tangent(const Vector<T>& direction);
  /// Derivative of `backward` along the direction of the last `tangent`, where
  /// out_bar moves along out_bar_dot.
  void backward_tangent(const Vector<T>& direction,
                        BatchIn<T> out_bar,
                        BatchIn<T> out_bar_dot,
                        Vector<T>& product);
  /// Running statistics follow the last `forward`.
  void update_state();
  /// Running statistics become those of these samples.
  void settle(BatchIn<T> input);
  /// One pass forward and back that leaves nothing behind but warm caches.
  void warm_up();

  /// Outputs for any input, with running statistics; not part of the method's
  /// counted work. The last `forward` of a minibatch cannot be pulled back
  /// afterwards.
  void predict(BatchIn<T> input, BatchOut<T> output);

  /// After `warm_up`, if the input is bound.
  void serialize(Archive& archive) { archive(parameters_, state_, fresh_); }

  const Tape& tape() const { return tape_; }
  Workspace& workspace() { return work_; }
  Vector<T>& parameters() { return parameters_; }
  const Vector<T>& state() const { return state_; }
  /// Mean |change| per tensor since `initialize(start)`.
  Batch<double> change_per_tensor(const Rng& start) const;

  const Counts& counts() const { return work_.counts; }
  std::size_t bytes() const;

 private:
  std::unique_ptr<Network<T>> network_;
  Vector<T> parameters_, state_, gradient_;
  Batch<T> input_, output_, output_dot_;
  Tape tape_, dots_, prediction_tape_;
  Workspace work_, prediction_work_;
  bool fresh_ = true;
};

extern template class NetworkModel<float>;
extern template class NetworkModel<double>;

}  // namespace physinv
