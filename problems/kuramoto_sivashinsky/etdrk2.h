/// The time step of the Kuramoto-Sivashinsky equation, forward, along
/// tangents and backward, one sample at a time: everything of a sample stays
/// in the first-level cache. Formulas in kuramoto_sivashinsky.h.
///
/// Fields are `cells` reals. Spectra are those of RealFft divided by `cells`,
/// so that the way back needs no scale. The spectrum is the state: a step in
/// any direction takes four real transforms (a pair of tangents: of two).
#pragma once

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/core/real_fft.h"

namespace physinv {

template <class T>
class Etdrk2 {
 public:
  explicit Etdrk2(const KuramotoSivashinskyOperators& op);

  Index cells() const { return cells_; }
  /// Reals that hold any field or spectrum, a multiple of 64 bytes.
  Index stride() const { return pair_.spectrum_stride(); }

  /// One sample under way: its unknowns, its spectrum and scratch, `stride`
  /// each. Fields that are passed along are 64-byte aligned.
  struct Run {
    T alpha, beta;
    T *s, *z, *w;
  };

  /// s := spectrum of u.
  void begin(const Run& r, const T* u) const;
  /// u, of spectrum s, to the middle stage a and to u_new, of spectrum s.
  void step(const Run& r, const T* u, T* a, T* u_new) const;
  /// The same for beta = 0 without u: s alone moves on.
  void drift(const Run& r) const;
  /// u := field of s.
  void restore(const Run& r, T* u) const;

  /// Derivatives of `step` along alpha and along beta, side by side. All have
  /// 2 `stride` reals: ds the spectra; du the fields, packed; z, w, da scratch.
  struct Tangents {
    T *ds, *du, *z, *w, *da;
  };
  void tangent_step(T beta, const T* u, const T* a, const Tangents& t) const;

  /// Sums over the steps that `pull` collects: the spectra dL/da^ and, by
  /// point, what beta multiplies. `stride` each, zero at first.
  struct Sums {
    T *alpha, *beta;
  };
  /// Takes s, the spectrum of dL/du_new, back over one step.
  void back_step(const Run& r, const T* u, const T* a, const Sums& sums) const;
  T alpha_bar(const Sums& sums) const;
  T beta_bar(const Sums& sums) const;

 private:
  void propagate(T alpha, T* s) const;

  Index cells_;
  RealFft<T> fft_, pair_;
  /// By real of a spectrum: E; P1 G^; -i k P1 / 2 and -i k P2 / 2 for spectra
  /// that still want their division by `cells`. A product with -i c reads
  /// (re, im) as (c im, -c re), so these hold (c, -c).
  Vector<T> exp_, forcing_, advect1_, advect2_;
};

extern template class Etdrk2<float>;
extern template class Etdrk2<double>;

}  // namespace physinv
