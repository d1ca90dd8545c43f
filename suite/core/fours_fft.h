/// The transforms of LanesFft, to the same bits, with four points of a signal
/// side by side: for signals that are too few for the lanes. Lane 4 s + l of a
/// pack belongs to signal s.
///
/// The complex signal z_j = u_2j + i u_2j+1 is in lanes j mod 4 of complex pack
/// j / 4, so that all passes but the one over neighbours run lane by lane; for
/// that one, four packs are transposed. Position p = 16 a + 4 c + b of LanesFft
/// is then lane c of complex pack 4 a + b. Nyquist's mode is lane 0 of the
/// last.
#pragma once

#include <utility>
#include <vector>

#include "suite/core/lanes_fft.h"
#include "suite/core/simd/samples.h"

namespace physinv {

template <class T>
class FoursFft {
 public:
  static constexpr Index kSide = 4;

  /// Of twice a power of 4, at least 32.
  static bool takes(Index size);
  explicit FoursFft(Index size);

  // As LanesFft has them.
  Index size() const { return lanes_.size(); }
  Index field() const { return size() / 4; }
  Index spectrum() const { return size() / 4 + 2; }
  Index mode(Index p) const { return lanes_.mode(p); }
  static Index point(Index r) { return r / 8 * 8 + r % 2 * 4 + r % 8 / 2; }
  Index place(Index i) const {
    const Index p = i / 2, part = i % 2 * 4;
    return p == size() / 2 ? size() + part
                           : p / 16 * 32 + p % 4 * 8 + p % 16 / 4 + part;
  }
  template <class P>
  PHYSINV_LANES static P weights(const T* numbers, Index i) {
    return spread<P>(load<Pack<T, 4>>(numbers + 4 * i));
  }
  template <class P>
  PHYSINV_LANES static P taken(const P* packs, Index at) {
    P v{};
    for (Index k = 0; k < kWidth<P>; k += 4) v[k] = packs[at / 4][k + at % 4];
    return v;
  }

  template <class P>
  void forward(const P* u, P* y) const;
  template <class P>
  void inverse(P* y, P* u) const;

 private:
  using Lanes = LanesFft<T>;
  template <class P>
  using Complex = typename Lanes::template Complex<P>;
  template <class P>
  static constexpr Index kWidth = sizeof(P) / sizeof(T);

  /// Four blocks of `quarter` complex packs each; for each of a quarter the
  /// three factors, real and imaginary parts of four lanes.
  struct Pass {
    Index quarter;
    std::vector<T> there, back;
  };
  /// Packs of modes m and, in the reverse order, M - m; factors of the first.
  struct Pair {
    Index low, high;
    T there[8], back[8];
  };

  template <class P>
  static constexpr auto lanes_of() {
    return std::make_integer_sequence<int, int(kWidth<P>)>();
  }
  template <class P, class V>
  PHYSINV_LANES static P spread(V v) {
    if constexpr (kWidth<V> == kWidth<P>) {
      return v;
    } else {
      return spread<P>(side_by_side(v, v));
    }
  }
  template <class P, int... I>
  PHYSINV_LANES static P reversed(P v, std::integer_sequence<int, I...>) {
    return __builtin_shufflevector(v, v, (I ^ 3)...);
  }
  /// Lanes 0, 3, 2, 1.
  template <class P, int... I>
  PHYSINV_LANES static P mirrored(P v, std::integer_sequence<int, I...>) {
    return __builtin_shufflevector(v, v, (I / 4 * 4 + (4 - I % 4) % 4)...);
  }
  /// Lane 0 of `first`, the others of v.
  template <class P, int... I>
  PHYSINV_LANES static P headed(P first,
                                P v,
                                std::integer_sequence<int, I...>) {
    return __builtin_shufflevector(
        first, v, (I % 4 == 0 ? I : I + int(sizeof...(I)))...);
  }
  /// The same of real and imaginary parts.
  template <class P>
  PHYSINV_LANES static Complex<P> reversed(Complex<P> v) {
    return {reversed(v.re, lanes_of<P>()), reversed(v.im, lanes_of<P>())};
  }
  template <class P>
  PHYSINV_LANES static Complex<P> mirrored(Complex<P> v) {
    return {mirrored(v.re, lanes_of<P>()), mirrored(v.im, lanes_of<P>())};
  }
  template <class P>
  PHYSINV_LANES static Complex<P> headed(Complex<P> first, Complex<P> v) {
    return {headed(first.re, v.re, lanes_of<P>()),
            headed(first.im, v.im, lanes_of<P>())};
  }

  template <bool kThere, bool kFirst, class P>
  static void four(const P* in, P* out, Index j, Index q, const T* w);
  template <bool kThere, class P>
  static void run(const Pass& pass, Index packs, const P* in, P* out);
  template <bool kThere, class P>
  static void run_neighbours(Index packs, const P* in, P* out);
  template <bool kThere, class P>
  static void split_pair(const Pair& s, Complex<P>& low, Complex<P>& high);
  template <bool kThere, class P>
  void split(P* y) const;

  Lanes lanes_;
  std::vector<Pass> passes_;  ///< the longest blocks first
  std::vector<Pair> pairs_;   ///< of packs that hold no multiples of M / 16
  Pair low_, middle_;         ///< of packs 0 and 1, which do
};

extern template bool FoursFft<float>::takes(Index);
extern template bool FoursFft<double>::takes(Index);
extern template FoursFft<float>::FoursFft(Index);
extern template FoursFft<double>::FoursFft(Index);

/// Point 0 of a block (kFirst: in lane 0) is not turned.
template <class T>
template <bool kThere, bool kFirst, class P>
PHYSINV_LANES void FoursFft<T>::four(
    const P* in, P* out, Index j, Index q, const T* w) {
  const auto turn = [w](Complex<P>& z, Index k) {
    const auto turned = z.times(weights<P>(w, 2 * k), weights<P>(w, 2 * k + 1));
    z = kFirst ? headed(z, turned) : turned;
  };
  auto a = Lanes::at(in, j), b = Lanes::at(in, j + q),
       c = Lanes::at(in, j + 2 * q), d = Lanes::at(in, j + 3 * q);
  if constexpr (!kThere) turn(b, 0), turn(c, 1), turn(d, 2);
  Lanes::template quartet<kThere>(a, b, c, d);
  if constexpr (kThere) turn(b, 0), turn(c, 1), turn(d, 2);
  Lanes::put(out, j, a), Lanes::put(out, j + q, b);
  Lanes::put(out, j + 2 * q, c), Lanes::put(out, j + 3 * q, d);
}

template <class T>
template <bool kThere, class P>
inline void FoursFft<T>::run(const Pass& pass,
                             Index packs,
                             const P* in,
                             P* out) {
  const Index q = pass.quarter;
  const T* const w = kThere ? pass.there.data() : pass.back.data();
  for (Index b = 0; b < packs; b += 4 * q) {
    four<kThere, true>(in, out, b, q, w);
    for (Index j = 1; j < q; ++j)
      four<kThere, false>(in, out, b + j, q, w + 24 * j);
  }
}

/// There, neighbours in four packs are moved to one lane of each; back, the
/// reverse.
template <class T>
template <bool kThere, class P>
inline void FoursFft<T>::run_neighbours(Index packs, const P* in, P* out) {
  for (Index j = 0; j < 2 * packs; j += 8) {
    P re[4], im[4];
    for (Index k = 0; k < 4; ++k)
      re[k] = in[j + 2 * k], im[k] = in[j + 2 * k + 1];
    if constexpr (kThere) transpose_four(re), transpose_four(im);
    Complex<P> z[4];
    for (Index k = 0; k < 4; ++k) z[k] = {re[k], im[k]};
    Lanes::template quartet<kThere>(z[0], z[1], z[2], z[3]);
    for (Index k = 0; k < 4; ++k) re[k] = z[k].re, im[k] = z[k].im;
    if constexpr (!kThere) transpose_four(re), transpose_four(im);
    for (Index k = 0; k < 4; ++k)
      out[j + 2 * k] = re[k], out[j + 2 * k + 1] = im[k];
  }
}

template <class T>
template <bool kThere, class P>
PHYSINV_LANES void FoursFft<T>::split_pair(const Pair& s,
                                           Complex<P>& low,
                                           Complex<P>& high) {
  const T* const w = kThere ? s.there : s.back;
  Lanes::template pair<kThere>(low, high, weights<P>(w, 0), weights<P>(w, 1));
}

/// Packs 0 to 3 have the multiples of M / 16, c + 4 b of them in lane c of pack
/// b; modes 0, M / 2 and Nyquist's are their own.
template <class T>
template <bool kThere, class P>
inline void FoursFft<T>::split(P* y) const {
  for (const Pair& s : pairs_) {
    auto low = Lanes::at(y, s.low), high = reversed(Lanes::at(y, s.high));
    split_pair<kThere>(s, low, high);
    Lanes::put(y, s.low, low), Lanes::put(y, s.high, reversed(high));
  }
  const Index last = field() / 2;
  const auto z0 = Lanes::at(y, 0), z1 = Lanes::at(y, 1), z2 = Lanes::at(y, 2),
             z3 = Lanes::at(y, 3), nyquist = Lanes::at(y, last);
  auto low = z0, high = mirrored(z3), middle = z1,
       above = headed(z3, mirrored(z2));
  split_pair<kThere>(low_, low, high);
  split_pair<kThere>(middle_, middle, above);
  Complex<P> zero, half;
  if constexpr (kThere) {
    zero = {z0.re + z0.im, P{}}, half = {z2.re, -z2.im};
    Lanes::put(y, last, headed({z0.re - z0.im, P{}}, Complex<P>{P{}, P{}}));
  } else {
    zero = {z0.re + nyquist.re, z0.re - nyquist.re};
    half = {T(2) * z2.re, T(-2) * z2.im};
  }
  Lanes::put(y, 0, headed(zero, low));
  Lanes::put(y, 1, middle);
  Lanes::put(y, 2, headed(half, mirrored(above)));
  Lanes::put(y, 3, headed(above, mirrored(high)));
}

template <class T>
template <class P>
void FoursFft<T>::forward(const P* u, P* y) const {
  const Index packs = field() / 2;
  const P* in = u;
  for (const Pass& p : passes_) run<true>(p, packs, in, y), in = y;
  run_neighbours<true>(packs, in, y);
  split<true>(y);
}

template <class T>
template <class P>
void FoursFft<T>::inverse(P* y, P* u) const {
  const Index packs = field() / 2;
  split<false>(y);
  run_neighbours<false>(packs, y, y);
  for (auto p = passes_.rbegin(); p != passes_.rend(); ++p)
    run<false>(*p, packs, y, p + 1 == passes_.rend() ? u : y);
}

}  // namespace physinv
