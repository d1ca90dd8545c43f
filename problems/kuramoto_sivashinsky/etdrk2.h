/// The time step of the Kuramoto-Sivashinsky equation, forward, along
/// tangents and backward, of a block of samples: one per lane of a pack P of
/// T. Formulas in kuramoto_sivashinsky.h.
///
/// Fields are `cells` packs. Spectra are those of LanesFft, in its order of
/// modes, divided by `cells`, so that the way back needs no scale. The spectrum
/// is the state: a step in any direction takes four real transforms.
#pragma once

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/core/lanes_fft.h"

namespace physinv {

/// Samples under way: their unknowns, their spectrum and scratch, `stride`
/// each.
template <class P>
struct Etdrk2Run {
  P alpha, beta;
  P *s, *z, *w;
};

/// Derivatives of `step` along one unknown: of the spectrum, of u and of the
/// middle stage, `stride` each.
template <class P>
struct Etdrk2Tangent {
  P *ds, *du, *da;
};

/// Sums over the steps that `pull` collects: the spectra dL/da^ and, by
/// point, what beta multiplies. `stride` each, zero at first.
template <class P>
struct Etdrk2Sums {
  P *alpha, *beta;
};

template <class T>
class Etdrk2 {
 public:
  explicit Etdrk2(const KuramotoSivashinskyOperators& op);

  Index cells() const { return cells_; }
  /// Packs that hold any field or spectrum.
  Index stride() const { return fft_.spectrum(); }

  /// s := spectrum of u.
  template <class P>
  void begin(const Etdrk2Run<P>& r, const P* u) const;
  /// u, of spectrum s, to the middle stage a and to u_new, of spectrum s.
  template <class P>
  void step(const Etdrk2Run<P>& r, const P* u, P* a, P* u_new) const;
  /// The same for beta = 0 without u: s alone moves on.
  template <class P>
  void drift(const Etdrk2Run<P>& r) const;
  /// u := field of s.
  template <class P>
  void restore(const Etdrk2Run<P>& r, P* u) const;

  template <class P>
  void tangent_step(const Etdrk2Run<P>& r,
                    const P* u,
                    const P* a,
                    const Etdrk2Tangent<P>& along_alpha,
                    const Etdrk2Tangent<P>& along_beta) const;

  /// Takes s, the spectrum of dL/du_new, back over one step.
  template <class P>
  void back_step(const Etdrk2Run<P>& r,
                 const P* u,
                 const P* a,
                 const Etdrk2Sums<P>& sums) const;
  template <class P>
  P alpha_bar(const Etdrk2Sums<P>& sums) const;
  template <class P>
  P beta_bar(const Etdrk2Sums<P>& sums) const;

 private:
  template <class P>
  void propagate(P alpha, P* s) const;

  Index cells_;
  LanesFft<T> fft_;
  /// By real of a spectrum: E; P1 G^; -i k P1 / 2 and -i k P2 / 2 for spectra
  /// that still want their division by `cells`. A product with -i c reads
  /// (re, im) as (c im, -c re), so these hold (c, -c).
  Vector<T> exp_, forcing_, advect1_, advect2_;
};

extern template class Etdrk2<float>;
extern template class Etdrk2<double>;

/// f(P{}) with the narrowest pack that holds so many samples.
template <class T, class F>
void with_pack(Index samples, F&& f) {
  constexpr int kHalf = 32 / static_cast<int>(sizeof(T)), kFew = kHalf / 2;
  if (samples <= kFew) {
    f(Pack<T, kFew>{});
  } else if (samples <= kHalf) {
    f(Pack<T, kHalf>{});
  } else {
    f(Pack<T>{});
  }
}

}  // namespace physinv
