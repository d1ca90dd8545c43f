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
LayerPointer<T> spectral_block(const SpectralOptions& options);

}  // namespace physinv::nn
