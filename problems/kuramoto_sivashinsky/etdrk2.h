/// The time step of the Kuramoto-Sivashinsky equation, forward, along
/// tangents and backward, of a block of samples in packs P of T, as the
/// transforms Fft have them: LanesFft<T>, one per lane, or FoursFft<T>, four
/// points of each. Formulas in kuramoto_sivashinsky.h.
///
/// Spectra are in the order of Fft, divided by `cells`, so that the way back
/// needs no scale. The spectrum is the state: a step in any direction takes
/// four real transforms.
#pragma once

#include <optional>

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/core/fours_fft.h"
#include "suite/core/lanes_fft.h"

namespace physinv {

/// Samples being simulated: their unknowns, their spectrum and scratch,
/// `stride` each.
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

template <class T, class Fft>
class Etdrk2 {
 public:
  explicit Etdrk2(const KuramotoSivashinskyOperators& op);

  /// Lanes that a sample has.
  static constexpr Index kSide = Fft::kSide;

  /// The place of value r of a field: lane at % kSide of pack at / kSide.
  static Index point(Index r) { return Fft::point(r); }
  /// Packs that hold a field, and any field or spectrum.
  Index field() const { return fft_.field(); }
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
  /// In the first lane of each sample.
  template <class P>
  P alpha_bar(const Etdrk2Sums<P>& sums) const;
  template <class P>
  P beta_bar(const Etdrk2Sums<P>& sums) const;

 private:
  template <class P>
  void propagate(P alpha, P* s) const;
  template <class P>
  PHYSINV_LANES static P weights(const Vector<T>& numbers, Index i) {
    return Fft::template weights<P>(numbers.data(), i);
  }

  Index cells_;
  Fft fft_;
  /// By number of a spectrum, in the order of fft_.place: E; P1 G^;
  /// -i k P1 / 2 and -i k P2 / 2 for spectra that still want their division by
  /// `cells`. A product with -i c reads (re, im) as (c im, -c re), so these
  /// hold (c, -c).
  Vector<T> exp_, forcing_, advect1_, advect2_;
};

extern template class Etdrk2<float, LanesFft<float>>;
extern template class Etdrk2<float, FoursFft<float>>;
extern template class Etdrk2<double, LanesFft<double>>;
extern template class Etdrk2<double, FoursFft<double>>;

/// The steps of any number of samples.
template <class T>
struct Etdrk2Kernels {
  explicit Etdrk2Kernels(const KuramotoSivashinskyOperators& op) : lanes(op) {
    if (FoursFft<T>::takes(op.forcing.size())) fours.emplace(op);
  }
  Etdrk2<T, LanesFft<T>> lanes;
  std::optional<Etdrk2<T, FoursFft<T>>> fours;
};

/// How many samples run together, of so many: as many as have four lanes each,
/// in at most two packs, or a register of them.
template <class T>
Index samples_together(const Etdrk2Kernels<T>& k, Index samples) {
  constexpr Index kAll = kLanes<T>;
  return k.fours && 2 * samples <= kAll ? kAll / 4 : kAll;
}

/// f(kernel, P{}) with the narrowest pack that holds them.
template <class T, class F>
void with_pack(const Etdrk2Kernels<T>& k, Index samples, F&& f) {
  constexpr int kAll = kLanes<T>, kHalf = 32 / static_cast<int>(sizeof(T)),
                kFew = kHalf / 2;
  if (k.fours && 4 * samples <= kAll) {
    if (samples == 1) {
      f(*k.fours, Pack<T, 4>{});
    } else if (4 * samples <= kHalf) {
      f(*k.fours, Pack<T, kHalf>{});
    } else {
      f(*k.fours, Pack<T>{});
    }
  } else if (samples <= kFew) {
    f(k.lanes, Pack<T, kFew>{});
  } else if (samples <= kHalf) {
    f(k.lanes, Pack<T, kHalf>{});
  } else {
    f(k.lanes, Pack<T>{});
  }
}

}  // namespace physinv
