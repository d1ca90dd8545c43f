/// Discrete Fourier transforms of real n x n fields, one field per lane.
///
/// Rows first, u_ij over j; what a row has at a position of the spectrum are
/// two reals, each of which is transformed over i as a signal of its own:
///
///   z[2 p + s][2 q + t],   p, q = 0 .. n/2,
///
/// is part t (real, imaginary) of mode(q) over rows of part s of mode(p) over
/// columns. So a factor that knows only |k| and |l| multiplies four numbers;
/// `scale_modes` puts together what stands for one mode.
#pragma once

#include "suite/core/lanes_fft.h"

namespace physinv {

class PlaneFft {
 public:
  explicit PlaneFft(Index n) : fft_(n) {}

  Index size() const { return fft_.size(); }
  Index positions() const { return size() / 2 + 1; }
  /// The mode |k| at position p.
  Index mode(Index p) const { return fft_.mode(p); }
  /// Packs of a field, of a spectrum, and of scratch for either direction.
  Index field() const { return size() * size(); }
  Index spectrum() const { return fft_.spectrum() * fft_.spectrum(); }
  Index scratch() const { return fft_.spectrum() * (size() + 1); }

  template <class P>
  void forward(const P* u, P* z, P* scratch) const {
    const Index n = size(), m = fft_.spectrum();
    P *const row = scratch, *const columns = scratch + m;
    for (Index i = 0; i < n; ++i) {
      fft_.forward(u + n * i, row);
      for (Index c = 0; c < m; ++c) columns[n * c + i] = row[c];
    }
    for (Index c = 0; c < m; ++c) fft_.forward(columns + n * c, z + m * c);
  }

  /// n^2 times the inverse. Destroys z.
  template <class P>
  void inverse(P* z, P* u, P* scratch) const {
    const Index n = size(), m = fft_.spectrum();
    P *const row = scratch, *const columns = scratch + m;
    for (Index c = 0; c < m; ++c) fft_.inverse(z + m * c, columns + n * c);
    for (Index i = 0; i < n; ++i) {
      for (Index c = 0; c < m; ++c) row[c] = columns[n * c + i];
      fft_.inverse(row, u + n * i);
    }
  }

  /// z <- g(p, q) z
  template <class P, class F>
  void scale(P* z, F&& g) const {
    const Index m = fft_.spectrum();
    for (Index p = 0; p < positions(); ++p)
      for (Index q = 0; q < positions(); ++q) {
        const double factor = g(p, q);
        P* const at = z + m * 2 * p + 2 * q;
        at[0] *= factor, at[1] *= factor;
        at[m] *= factor, at[m + 1] *= factor;
      }
  }

  /// z <- g z, mode by mode: g(p, q, re, im) is asked about the modes (k, l)
  /// and (-k, l), l = mode(p), k = mode(q), one after the other, the latter as
  /// its conjugate. A k that is its own negative comes twice.
  template <class P, class F>
  void scale_modes(P* z, F&& g) const {
    const Index m = fft_.spectrum();
    for (Index p = 0; p < positions(); ++p)
      for (Index q = 0; q < positions(); ++q) {
        P *const a = z + m * 2 * p + 2 * q, *const b = a + m;
        const P plus[] = {a[0] - b[1], a[1] + b[0]};
        const P minus[] = {a[0] + b[1], a[1] - b[0]};
        const P up = 0.5 * g(p, q, plus[0], plus[1]);
        const P down = 0.5 * g(p, q, minus[0], minus[1]);
        for (int t = 0; t < 2; ++t)
          a[t] = fma_lanes(up, plus[t], down * minus[t]);
        b[0] = fma_lanes(up, plus[1], -(down * minus[1]));
        b[1] = fma_lanes(down, minus[0], -(up * plus[0]));
      }
  }

 private:
  LanesFft<double> fft_;
};

}  // namespace physinv
