/// What a network's output o means: an estimate of the unknowns, one column per
/// sample (OutputForm in suite/core/method.h).
#pragma once

#include <memory>

#include "suite/core/method.h"

namespace physinv {

template <class T>
class OutputMap {
 public:
  virtual ~OutputMap() = default;

  /// x of these outputs; y are the observations the network was asked about.
  virtual void operator()(BatchIn<T> out, BatchIn<T> y, BatchOut<T> x) = 0;

  /// Gradients by the last x become gradients by its outputs, in place.
  /// Directions of the outputs become those of x: every form's Jacobian is
  /// symmetric.
  virtual void pull_back(BatchOut<T> bar) const = 0;
  /// Adds what the form's own bend does to gradients `bar` by the outputs where
  /// these move along `dot`.
  virtual void bend(BatchIn<T> /*bar*/,
                    BatchIn<T> /*dot*/,
                    BatchOut<T> /*bar_dot*/) const {}
  /// The same for the rows of Jacobians: column i of `jacobian` is sample i's,
  /// observations x unknowns, column-major.
  virtual void pull_back_rows(BatchOut<T> jacobian) const = 0;

  /// The outputs that mean x, of forms that have an inverse.
  virtual Batch<T> outputs_of(BatchIn<T> x) const;
};

/// As a setting has it, around the start of the oracle's problems.
template <class T>
std::unique_ptr<OutputMap<T>> output_map(const Setting& setting,
                                         const Oracle& oracle);

/// The same with its parts.
template <class T>
std::unique_ptr<OutputMap<T>> output_map(OutputForm form,
                                         double scale,
                                         const Vector<double>& start);

extern template class OutputMap<float>;
extern template class OutputMap<double>;

}  // namespace physinv
