/// One block of a Fourier neural operator, on rows laid out position by
/// position (see window.h):
///
///   y = S f(x) + W f(x) + b
///
/// f is an activation, W a 1-tap convolution, S a convolution by its modes on
/// the `period`, to which x is extended by zeros:
///
///   Z = FFT f(x),  A[o](k, l) = sum_c V[c][o](k, l) Z[c](k, l),  S f(x) =
///   Re FFT^-1 A
///
/// over the first and last `modes` row frequencies k and the first `modes`
/// column frequencies l, of which those with l > 0 count twice for their
/// conjugates. Only the part of y on `to` is computed.
///
/// Parameters: V (see mode_product.h); W [out][in]; b.
///
/// The tape holds Z alone: f(x) is made again in `backward`, where its
/// derivative needs the same functions.
#pragma once

#include <vector>

#include "suite/nn/layer.h"
#include "suite/nn/mode_product.h"
#include "suite/nn/plane_modes.h"

namespace physinv::nn {

struct SpectralOptions {
  Grid from, to;  ///< of x and of y
  Grid period;    ///< at least both; columns at least 2 modes, rows modes
  Index channels = 32, modes = 12;
  Activation before = Activation::identity;  ///< f
};

template <class T>
class SpectralBlock final : public Layer<T> {
 public:
  explicit SpectralBlock(const SpectralOptions& options);

  std::vector<TensorInfo> tensors() const override;
  std::size_t slots() const override { return 1; }
  void forward(const LayerArgs<T>& at,
               Lanes<const T> x,
               Lanes<T> y) const override;
  void backward(const LayerArgs<T>& at, const Backward<T>& b) const override;
  void tangent(const LayerArgs<T>& at, const Tangent<T>& t) const override;
  void backward_tangent(const LayerArgs<T>& at,
                        const BackwardTangent<T>& b) const override;
  double operations() const override;

 private:
  /// One product (S + W) f(x), bilinear in weights and f(x).
  struct Product {
    const T* parameters;  ///< S and W
    const T* bias = nullptr;
    Activation f = Activation::identity;
    /// Its derivative multiplies x_bar, which else is f(x)'s cotangent.
    Activation gate = Activation::identity;
    T* modes;  ///< Z, written on the way up, read on the way down
  };

  T* open_modes(const Lanes<const T>& x, Tape& tape, std::size_t slot) const;
  void apply(const Product& at,
             Lanes<const T> x,
             Lanes<T> y,
             Workspace& all) const;
  /// Leaves x_bar without b.gate.
  void pull(const Product& at, const Backward<T>& b, Workspace& all) const;

  const PlaneModes<T>& in() const { return product_.sums(); }
  const T* local(const T* parameters) const {
    return parameters + product_.parameter_count();
  }
  const T* bias(const T* parameters) const {
    return local(parameters) + o_.channels * o_.channels;
  }
  bool meets(Index r) const { return r < shared_.rows; }

  void pull_inputs(const Product& at,
                   bool meets,
                   const T* row,
                   Lanes<const T> x,
                   Lanes<const T> y_bar,
                   Lanes<T> x_bar) const;
  /// x_bar and W_bar row by row; t: the sums of x's cotangent, or null.
  void pull_rows(const Product& at,
                 const Backward<T>& b,
                 const T* t,
                 Workspace& all) const;

  SpectralOptions o_;
  Grid shared_;             ///< positions that both x and y have
  ModeProduct<T> product_;  ///< S between the transforms
  PlaneModes<T> out_;
};

extern template class SpectralBlock<float>;
extern template class SpectralBlock<double>;

}  // namespace physinv::nn
