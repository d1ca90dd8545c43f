/// Positional encoding: each scalar a becomes sin(a), ..., sin(K a), cos(a),
/// ..., cos(K a); scalars in order. K frequencies, 2 K features per scalar.
///
/// One sine and one cosine per scalar, the multiples by angle addition, in
/// double and then rounded: error below 2 K ulp of double.
#pragma once

#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
class PositionalEncoding final : public Layer<T> {
 public:
  PositionalEncoding(Index inputs, Index frequencies)
      : Layer<T>(inputs, 2 * frequencies * inputs), frequencies_(frequencies) {}

  void forward(const LayerArgs<T>& at,
               Lanes<const T> x,
               Lanes<T> y) const override;
  void backward(const LayerArgs<T>& at, const Backward<T>& b) const override;
  void tangent(const LayerArgs<T>& at, const Tangent<T>& t) const override;
  void backward_tangent(const LayerArgs<T>& at,
                        const BackwardTangent<T>& b) const override;

 private:
  Index frequencies_;
};

extern template class PositionalEncoding<float>;
extern template class PositionalEncoding<double>;

}  // namespace physinv::nn
