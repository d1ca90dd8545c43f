/// Discrete Fourier transforms of real signals side by side, one signal per
/// lane: no shuffles, and bits that depend on no processor and no neighbour.
/// Of few signals, four points of each are side by side (fours_fft.h).
///
/// Real signals of n = 2 M points are complex ones of M, z_j = u_2j + i u_2j+1
/// (radix 4, decimated in frequency on the way there and in time on the way
/// back, in place), taken apart by a last step. The factors of modes do not
/// depend on their order, so spectra stay in the order that the passes leave:
/// `mode(p)` is the mode at position p.
#pragma once

#include <vector>

#include "suite/core/simd/pack.h"

namespace physinv {

template <class T>
class FoursFft;

template <class T>
class LanesFft {
 public:
  /// Numbers of a signal that are side by side in a pack.
  static constexpr Index kSide = 1;

  /// `size` is a power of two, at least 4.
  explicit LanesFft(Index size);

  Index size() const { return 2 * half_; }
  /// Packs of a signal.
  Index field() const { return size(); }
  /// Packs of a spectrum: real and imaginary part of size / 2 + 1 modes.
  Index spectrum() const { return 2 * half_ + 2; }
  /// The mode at position p = 0 .. size / 2; the last one is Nyquist's.
  Index mode(Index p) const { return p == half_ ? half_ : mode_[p]; }

  /// Where point r of a signal, and number i = 2 p or 2 p + 1 of a spectrum
  /// (real and imaginary part at position p) are: lane at % kSide of pack at /
  /// kSide.
  static Index point(Index r) { return r; }
  Index place(Index i) const { return i; }
  /// What pack i of a field or spectrum is multiplied by, of numbers in the
  /// order of `place`.
  template <class P>
  PHYSINV_LANES static P weights(const T* numbers, Index i) {
    return broadcast<P>(numbers[i]);
  }
  /// The number at `at`, in the first lane of each signal.
  template <class P>
  PHYSINV_LANES static P taken(const P* packs, Index at) {
    return packs[at];
  }

  /// y_m = sum_j u_j exp(-2 pi i j m / size), in the order of positions.
  template <class P>
  void forward(const P* u, P* y) const;

  /// u_j = sum_m y_m exp(2 pi i j m / size) over all modes, those above
  /// size / 2 being the conjugates of the others: `size` times the inverse.
  /// Destroys y.
  template <class P>
  void inverse(P* y, P* u) const;

 private:
  friend class FoursFft<T>;

  template <class P>
  struct Complex {
    P re, im;
    PHYSINV_LANES friend Complex operator+(Complex a, Complex b) {
      return {a.re + b.re, a.im + b.im};
    }
    PHYSINV_LANES friend Complex operator-(Complex a, Complex b) {
      return {a.re - b.re, a.im - b.im};
    }
    PHYSINV_LANES Complex conjugate() const { return {re, -im}; }
    PHYSINV_LANES Complex times_i() const { return {-im, re}; }
    /// times c + i s
    PHYSINV_LANES Complex times(P c, P s) const {
      return {fma_lanes(re, c, -(im * s)), fma_lanes(re, s, im * c)};
    }
    /// times w[0] + i w[1]
    PHYSINV_LANES Complex times(const T* w) const {
      return times(P{} + w[0], P{} + w[1]);
    }
  };
  template <class P>
  PHYSINV_LANES static Complex<P> at(const P* z, Index j) {
    return {z[2 * j], z[2 * j + 1]};
  }
  template <class P>
  PHYSINV_LANES static void put(P* z, Index j, Complex<P> v) {
    z[2 * j] = v.re, z[2 * j + 1] = v.im;
  }

  /// The transform of four points.
  template <bool kThere, class P>
  PHYSINV_LANES static void quartet(Complex<P>& a,
                                    Complex<P>& b,
                                    Complex<P>& c,
                                    Complex<P>& d) {
    const auto ac = a + c, a_c = a - c, bd = b + d;
    const auto turned = kThere ? (d - b).times_i() : (b - d).times_i();
    a = ac + bd, b = a_c + turned, c = ac - bd, d = a_c - turned;
  }

  /// Modes m and M - m of the complex signal become those of the real one, or
  /// the reverse. There: Y_m = E + W O, Y_(M-m) = (E - W O)* with
  /// 2 E = Z_m + Z*_(M-m) and 2 O = -i (Z_m - Z*_(M-m)),
  /// W = exp(-2 pi i m / size), w = W / 2. Back, twice the above undone:
  /// Z_m = (Y_m + Y*_(M-m)) + i W* (Y_m - Y*_(M-m)), w = W*.
  template <bool kThere, class P>
  PHYSINV_LANES static void pair(Complex<P>& low,
                                 Complex<P>& high,
                                 P w_re,
                                 P w_im) {
    const auto a = low, b = high.conjugate(), sum = a + b;
    if constexpr (kThere) {
      const auto odd = (b - a).times_i().times(w_re, w_im);
      const Complex<P> even{T(0.5) * sum.re, T(0.5) * sum.im};
      low = even + odd, high = (even - odd).conjugate();
    } else {
      const auto odd = (a - b).times(w_re, w_im).times_i();
      low = sum + odd, high = (sum - odd).conjugate();
    }
  }

  /// Blocks of `length` points, four of each a quarter apart. For point j of a
  /// quarter: exp(-2 pi i j / length), its square, its cube; their conjugates.
  struct Pass {
    Index length;
    std::vector<T> there, back;
  };
  /// Modes m and M - m, m < M / 2, and exp(-2 pi i m / size) / 2.
  struct Pair {
    Index p, q;
    T there[2], back[2];
  };

  /// Positions first .. of a block hold modes offset, offset + step, ..
  void place(Index first, Index length, Index offset, Index step);
  template <bool kThere, bool kTurned, class P>
  static void four(const P* in, P* out, Index j, Index q, const T* w);
  template <bool kThere, class P>
  static void run(const Pass& pass, Index points, const P* in, P* out);
  template <class P>
  static void run_pairs(Index points, const P* in, P* out);
  template <bool kThere, class P>
  void split(P* y) const;

  Index half_;                ///< M
  std::vector<Pass> passes_;  ///< the longest blocks first
  bool pairs_last_;           ///< blocks of two come last
  std::vector<Index> mode_;
  std::vector<Pair> split_;
  Index middle_;  ///< where mode M / 2 is
};

extern template LanesFft<float>::LanesFft(Index);
extern template LanesFft<double>::LanesFft(Index);

template <class T>
template <bool kThere, bool kTurned, class P>
PHYSINV_LANES void LanesFft<T>::four(
    const P* in, P* out, Index j, Index q, const T* w) {
  Complex<P> a = at(in, j), b = at(in, j + q), c = at(in, j + 2 * q),
             d = at(in, j + 3 * q);
  if constexpr (!kThere && kTurned)
    b = b.times(w), c = c.times(w + 2), d = d.times(w + 4);
  quartet<kThere>(a, b, c, d);
  if constexpr (kThere && kTurned)
    b = b.times(w), c = c.times(w + 2), d = d.times(w + 4);
  put(out, j, a), put(out, j + q, b);
  put(out, j + 2 * q, c), put(out, j + 3 * q, d);
}

template <class T>
template <bool kThere, class P>
inline void LanesFft<T>::run(const Pass& pass,
                             Index points,
                             const P* in,
                             P* out) {
  const Index q = pass.length / 4;
  const T* const w = kThere ? pass.there.data() : pass.back.data();
  for (Index b = 0; b < points; b += pass.length) {
    four<kThere, false>(in, out, b, q, w);
    for (Index j = 1; j < q; ++j)
      four<kThere, true>(in, out, b + j, q, w + 6 * j);
  }
}

template <class T>
template <class P>
inline void LanesFft<T>::run_pairs(Index points, const P* in, P* out) {
  for (Index j = 0; j < points; j += 2) {
    const auto a = at(in, j), b = at(in, j + 1);
    put(out, j, a + b), put(out, j + 1, a - b);
  }
}

template <class T>
template <bool kThere, class P>
PHYSINV_LANES void LanesFft<T>::split(P* y) const {
  for (const Pair& s : split_) {
    const T* const w = kThere ? s.there : s.back;
    auto low = at(y, s.p), high = at(y, s.q);
    pair<kThere>(low, high, P{} + w[0], P{} + w[1]);
    put(y, s.p, low), put(y, s.q, high);
  }
}

template <class T>
template <class P>
void LanesFft<T>::forward(const P* u, P* y) const {
  const P* in = u;
  for (const Pass& p : passes_) run<true>(p, half_, in, y), in = y;
  if (pairs_last_) run_pairs(half_, in, y);
  const auto zero = at(y, 0);
  put<P>(y, 0, {zero.re + zero.im, P{}});
  put<P>(y, half_, {zero.re - zero.im, P{}});
  y[2 * middle_ + 1] = -y[2 * middle_ + 1];
  split<true>(y);
}

template <class T>
template <class P>
void LanesFft<T>::inverse(P* y, P* u) const {
  const P first = y[0], last = y[2 * half_];
  put<P>(y, 0, {first + last, first - last});
  put<P>(y, middle_, {T(2) * y[2 * middle_], T(-2) * y[2 * middle_ + 1]});
  split<false>(y);
  P* const end = passes_.empty() ? u : y;
  if (pairs_last_) run_pairs(half_, y, end);
  for (auto p = passes_.rbegin(); p != passes_.rend(); ++p)
    run<false>(*p, half_, y, p + 1 == passes_.rend() ? u : y);
}

}  // namespace physinv
