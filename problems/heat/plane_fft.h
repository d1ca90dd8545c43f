/// Discrete Fourier transforms of real n x n fields, one field per lane.
///
/// Rows first, u_ij over j; what a row has at a position of the spectrum are
/// two reals, each of which is transformed over i as a signal of its own:
///
///   z[2 p + s][2 q + t],   p, q = 0 .. n/2,
///
/// is part t (real, imaginary) of mode(q) over rows of part s of mode(p) over
/// columns. So a factor that depends only on |k| and |l| multiplies four
/// numbers; `scale_modes` combines the numbers of one mode.
#pragma once

#include <array>

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

  /// f(p, q, i) of all positions, i[0..3] being where its four numbers are.
  template <class F>
  void for_positions(F&& f) const {
    const Index m = fft_.spectrum();
    for (Index p = 0; p < positions(); ++p)
      for (Index q = 0; q < positions(); ++q) {
        const Index at = m * 2 * p + 2 * q;
        f(p, q, std::array{at, at + 1, at + m, at + m + 1});
      }
  }

  /// z <- g(p, q) z
  template <class P, class F>
  void scale(P* z, F&& g) const {
    for_positions([&](Index p, Index q, const auto& at) {
      const double factor = g(p, q);
      for (const Index i : at) z[i] *= factor;
    });
  }

  /// The four numbers at a position, times g(re, im) of the modes (k, l) and
  /// (-k, l) there, one after the other, the latter as its conjugate. A k that
  /// is its own negative comes twice.
  template <class P, class F>
  static void scale_modes_at(std::array<P, 4>& z, F&& g) {
    const P plus[] = {z[0] - z[3], z[1] + z[2]};
    const P minus[] = {z[0] + z[3], z[1] - z[2]};
    const P up = 0.5 * g(plus[0], plus[1]);
    const P down = 0.5 * g(minus[0], minus[1]);
    z[0] = fma_lanes(up, plus[0], down * minus[0]);
    z[1] = fma_lanes(up, plus[1], down * minus[1]);
    z[2] = fma_lanes(up, plus[1], -(down * minus[1]));
    z[3] = fma_lanes(down, minus[0], -(up * plus[0]));
  }

  /// z <- g z, g(p, q, re, im) being asked about every mode, l = mode(p), k =
  /// mode(q).
  template <class P, class F>
  void scale_modes(P* z, F&& g) const {
    for_positions([&](Index p, Index q, const auto& at) {
      std::array here{z[at[0]], z[at[1]], z[at[2]], z[at[3]]};
      scale_modes_at(here, [&](P re, P im) { return g(p, q, re, im); });
      for (std::size_t i = 0; i < 4; ++i) z[at[i]] = here[i];
    });
  }

 private:
  LanesFft<double> fft_;
};

}  // namespace physinv
