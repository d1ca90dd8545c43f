/// Discrete Fourier transforms of real signals of any size, by FFTW: what tests
/// and kernels compare the suite's own transforms with. A program that links it
/// (target physinv_fftw) is under the GPL as a whole; no program that runs
/// cases does.
///
/// Plans are made once per process and size with FFTW_ESTIMATE, which times
/// nothing, and run on arrays of one alignment: the bits of a transform depend
/// only on its input and, with SIMD codelets, on the processor. Any number of
/// threads may share an object.
#pragma once

#include <memory>

#include "suite/core/batch.h"

namespace physinv {

/// FFTW chooses its SIMD codelets by the processor; scalar ones round alike on
/// all.
enum class Codelets { scalar, simd };

template <class T>
class RealFft {
 public:
  /// `count` independent signals of `size` >= 1 points per call.
  explicit RealFft(Index size,
                   Index count = 1,
                   Codelets codelets = Codelets::scalar);

  /// Reals from one signal, and from one spectrum, to the next of a call: the
  /// least that keeps each at a multiple of 64 bytes.
  Index signal_stride() const { return signal_stride_; }
  Index spectrum_stride() const { return spectrum_stride_; }

  /// y_m = sum_j u_j exp(-2 pi i j m / size) for m = 0 .. size / 2, real and
  /// imaginary parts interleaved. Arrays are 64-byte aligned and do not
  /// overlap.
  void forward(const T* u, T* y) const;

  /// u_j = sum_m y_m exp(2 pi i j m / size) over all modes, those above
  /// size / 2 being the conjugates of the others: `size` times the inverse.
  /// Destroys y, because that makes it twice as fast.
  void inverse(T* y, T* u) const;

 private:
  struct Plans;
  static std::shared_ptr<const Plans> plans(Index size,
                                            Index count,
                                            Codelets codelets);

  Index signal_stride_, spectrum_stride_;
  std::shared_ptr<const Plans> plans_;
};

extern template class RealFft<float>;
extern template class RealFft<double>;

}  // namespace physinv
