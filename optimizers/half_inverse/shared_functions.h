/// The triangle of a stacked Jacobian of a network with one hidden layer whose
/// outputs are seen alike in every sample.
///
/// Function c of a sample reads output c only, times s_c. Then all columns of
/// J come from one matrix, the same for all functions,
///
///   F = [h, 1, d (outer) (x, 1)]   (samples x hidden + 1 + hidden (inputs +
///   1))
///
/// d the derivatives of the hidden units, and the triangle of [F, g_1, g_2..]
/// has all that is needed: with its blocks R_HH, R_HE, R_EE,
///
///   J ~ [ R_HH s_1              R_HE q_1 ]
///       [           R_HH s_2    R_HE q_2 ]   q_c = s_c W_c: weights behind
///       [                       R_EE q_1 ]         each hidden unit
///       [                       R_EE q_2 ]
///
/// in an order of the columns that is undone at the end; only the last two
/// rows still have to become a triangle. For 256 samples of a 1-7-2 network
/// this is a third of the work for the 512 x 30 Jacobian.
#pragma once

#include <span>

#include "suite/linalg/tall_qr.h"
#include "suite/nn/layer_rows.h"

namespace physinv::hig {

class SharedFunctions {
 public:
  /// [R h] (p x p + 1) with columns in the order of `place`: parameter place(j)
  /// is column j. False if the network or its solver is of another kind, or
  /// there are too few samples. `layers` as RowJacobian gives them, g and rows
  /// sample-major, `per_sample` functions.
  template <class T>
  bool triangle(std::span<const LayerRows<T>> layers,
                VectorIn<T> parameters,
                VectorIn<double> g,
                Index per_sample);

  const Batch<double>& result() const { return r_; }
  const std::vector<Index>& place() const { return place_; }
  std::size_t bytes() const { return features_.bytes() + rest_.bytes(); }

 private:
  struct Sizes;
  template <class T>
  Index best_function(const Sizes& n, const T* weights, Index unit);
  template <class T>
  void write_unit(const Sizes& n,
                  const LayerRows<T>& hidden,
                  Index unit,
                  Index function);
  template <class T>
  void write_features(const Sizes& n,
                      const LayerRows<T>& output,
                      const LayerRows<T>& hidden,
                      VectorIn<T> parameters,
                      VectorIn<double> g);
  void put_function(const Sizes& n, Index function, Index offset);

  linalg::TallColumns features_, rest_;
  Batch<double> top_, corner_, r_;
  std::vector<double> seen_, ratio_;
  std::vector<Index> place_;
};

}  // namespace physinv::hig
