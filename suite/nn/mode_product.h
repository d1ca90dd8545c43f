/// The middle of a convolution by modes (spectral.h), between the transform of
/// its inputs and that of its outputs: the modes of every output from those of
/// all inputs,
///
///   A[o](k, l) = sum_c V[c][o](k, l) Z[c](k, l)
///
/// over the first and last `modes` row frequencies k and the first `modes`
/// column frequencies l of the `period`. It works in place on the sums of sines
/// and cosines that PlaneModes makes and takes, with the weights of the inverse
/// transform in it.
///
/// Parameters: V of the first k, V of the last k, real before imaginary part,
/// [in][out][k][l] each. With fewer than 2 `modes` rows the last k are taken
/// from where both have them, and the first have no effect there.
#pragma once

#include <vector>

#include "suite/core/workspace.h"
#include "suite/nn/plane_modes.h"

namespace physinv::nn {

template <class T>
class ModeProduct {
 public:
  /// grid: positions of the inputs. The period has at least 2 `modes` columns
  /// and `modes` rows.
  ModeProduct(Grid grid, Grid period, Index channels, Index modes);

  const PlaneModes<T>& sums() const { return sums_; }
  /// Largest row frequency + 1.
  Index row_count() const;
  /// Complex numbers of Z for one channel and sample.
  Index mode_count() const;
  Index parameter_count() const { return 4 * spectral_size(); }

  /// u <- sums of what V makes of the modes in u; z <- these.
  void apply(
      const T* parameters, Index samples, T* u, T* z, Workspace& all) const;
  /// u <- cotangent of the modes, from that of what was made of them, if
  /// wanted; parameters_bar, unless null, must be zero.
  void pull(const T* parameters,
            const T* z,
            Index samples,
            T* u,
            T* parameters_bar,
            bool wants_u,
            Workspace& all) const;

 private:
  /// Row frequency `sign` k, whose weights are row `row` of tensors 2 `last`
  /// (real) and 2 `last` + 1. Its modes are the `number`-th on the tape.
  struct Mode {
    int sign;
    Index last, row, number;
  };

  Index mode_size() const { return modes_ * modes_; }
  Index spectral_size() const { return channels_ * channels_ * mode_size(); }
  /// Of the weights of all l, from the first input to the first output.
  Index place(const Mode& m, Index part) const {
    return (2 * m.last + part) * spectral_size() + m.row * modes_;
  }
  /// Modes of frequency (m.sign k, l) from the sums u, and the transpose.
  void gather(
      const T* u, Index k, const Mode& m, Index l, Index block, T* z) const;
  void scatter(
      const T* z, Index k, const Mode& m, Index l, Index block, T* u) const;
  /// V(k, .) as [real, imaginary][l][in][out].
  void unpack(const T* parameters, const Mode& m, T* weights) const;
  /// [in re, in im][out re, out im]: the product with V(k, l) in real numbers,
  /// with the weight of the inverse transform.
  void real_matrix(const T* weights, Index l, T* matrix) const;
  double inverse_weight(Index l) const;

  void pull_weights(const T* z,
                    const T* a_bar,
                    Index samples,
                    const Mode& m,
                    T* parameters_bar,
                    Workspace& work) const;
  Grid period_;
  Index channels_, modes_;
  PlaneModes<T> sums_;
  std::vector<std::vector<Mode>> frequencies_;  ///< by k
};

extern template class ModeProduct<float>;
extern template class ModeProduct<double>;

}  // namespace physinv::nn
