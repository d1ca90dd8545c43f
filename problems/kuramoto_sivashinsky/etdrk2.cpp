#include "problems/kuramoto_sivashinsky/etdrk2.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "suite/core/math.h"
#include "suite/core/simd/math.h"
#include "suite/core/workspace.h"

namespace physinv {
namespace {

/// phi1 and phi2: (e^z - 1) / z and (e^z - 1 - z) / z^2; their differences
/// cancel near 0, where the series to z^5 is exact to rounding.
std::array<double, 2> phi(double z) {
  if (std::abs(z) >= 1e-2) {
    const double e = math::expm1(z);
    return {e / z, (e - z) / (z * z)};
  }
  double one = 1, two = 1;
  for (int i = 6; i > 1; --i) one = 1 + z / i * one;
  for (int i = 7; i > 2; --i) two = 1 + z / i * two;
  return {one, two / 2};
}

double forcing_at(double x) {
  return 0.1 * math::cos(x) -
         0.01 * math::cos(x / 16) * (1 - 2 * math::sin(x / 16));
}

/// s := s + scale (-i c) z, and z := s, which transforms may destroy.
template <class Fft, class P, class T>
PHYSINV_LANES void add_turned(
    Index count, P scale, const T* c, P* __restrict s, P* __restrict z) {
  const auto turn = [c](Index i) { return Fft::template weights<P>(c, i); };
  for (Index i = 0; i < count; i += 2) {
    const P re = z[i], im = z[i + 1];
    z[i] = s[i] = fma_lanes(scale * turn(i), im, s[i]);
    z[i + 1] = s[i + 1] = fma_lanes(scale * turn(i + 1), re, s[i + 1]);
  }
}

template <class P>
constexpr Index kWidth = sizeof(P) / sizeof(LaneScalar<P>);

}  // namespace

KuramotoSivashinskyOperators operators(const KuramotoSivashinskyOptions& o) {
  const Index modes = o.cells / 2 + 1;
  KuramotoSivashinskyOperators op;
  for (auto* v : {&op.k, &op.linear, &op.exp, &op.dt_phi1, &op.dt_phi2})
    v->resize(modes);
  for (Index m = 0; m < modes; ++m) {
    const double k = double(m) / o.box, l = k * k - k * k * k * k;
    const auto [phi1, phi2] = phi(l * o.time_step);
    op.k(m) = k, op.linear(m) = l;
    op.exp(m) = math::exp(l * o.time_step);
    op.dt_phi1(m) = o.time_step * phi1;
    op.dt_phi2(m) = o.time_step * phi2;
  }
  op.forcing.resize(o.cells);
  for (Index j = 0; j < o.cells; ++j)
    op.forcing(j) = forcing_at((double(j) + 0.5) * (o.box / double(o.cells)));
  return op;
}

template <class T, class Fft>
Etdrk2<T, Fft>::Etdrk2(const KuramotoSivashinskyOperators& op)
    : cells_(op.forcing.size()), fft_(cells_) {
  using One = Pack<double, 2>;
  const Index modes = op.k.size();
  const double n = static_cast<double>(cells_);
  const LanesFft<double> fft(cells_);
  Workspace work;
  auto g = work.take<double>(2, cells_);
  auto spectrum = work.take<double>(2, 2 * modes);
  g.rowwise() = op.forcing.transpose();
  fft.forward(reinterpret_cast<const One*>(g.data()),
              reinterpret_cast<One*>(spectrum.data()));
  for (auto* v : {&exp_, &forcing_, &advect1_, &advect2_})
    v->setZero(kSide * stride());
  for (Index i = 0; i < 2 * modes; ++i) {
    const Index m = fft_.mode(i / 2), at = fft_.place(i);
    // The Nyquist mode has no derivative.
    const double k = m == modes - 1 ? 0 : op.k(m) * (i % 2 == 0 ? 1 : -1);
    exp_(at) = static_cast<T>(op.exp(m));
    forcing_(at) = static_cast<T>(op.dt_phi1(m) * spectrum(0, i) / n);
    advect1_(at) = static_cast<T>(k * op.dt_phi1(m) / (2 * n));
    advect2_(at) = static_cast<T>(k * op.dt_phi2(m) / (2 * n));
  }
}

template <class T, class Fft>
template <class P>
void Etdrk2<T, Fft>::begin(const Etdrk2Run<P>& r, const P* u) const {
  fft_.forward(u, r.s);
  const T scale = T(1) / static_cast<T>(cells_);
  for (Index i = 0; i < stride(); ++i) r.s[i] *= scale;
}

template <class T, class Fft>
template <class P>
void Etdrk2<T, Fft>::restore(const Etdrk2Run<P>& r, P* u) const {
  std::copy_n(r.s, stride(), r.z);
  fft_.inverse(r.z, u);
}

/// s := E s + alpha P1 G^. Where alpha is 0, no forcing is added: the sign of
/// a zero depends on no neighbour.
template <class T, class Fft>
template <class P>
void Etdrk2<T, Fft>::propagate(P alpha, P* s) const {
  const auto e = [&](Index i) { return weights<P>(exp_, i); };
  const auto f = [&](Index i) { return weights<P>(forcing_, i); };
  const Index count = stride();
  const auto unforced = alpha == P{};
  const Index zeros = count_set(unforced);
  if (zeros == kWidth<P>) {
    for (Index i = 0; i < count; ++i) s[i] *= e(i);
  } else if (zeros == 0) {
    for (Index i = 0; i < count; ++i)
      s[i] = fma_lanes(alpha, f(i), e(i) * s[i]);
  } else {
    for (Index i = 0; i < count; ++i) {
      const P drift = e(i) * s[i];
      s[i] = select(unforced, drift, fma_lanes(alpha, f(i), drift));
    }
  }
}

template <class T, class Fft>
template <class P>
void Etdrk2<T, Fft>::drift(const Etdrk2Run<P>& r) const {
  propagate(r.alpha, r.s);
}

template <class T, class Fft>
template <class P>
void Etdrk2<T, Fft>::step(const Etdrk2Run<P>& r,
                          const P* u,
                          P* a,
                          P* u_new) const {
  const Index n = field();
  P* __restrict w = r.w;
  for (Index j = 0; j < n; ++j) w[j] = u[j] * u[j];
  fft_.forward(w, r.z);
  propagate(r.alpha, r.s);
  add_turned<Fft>(stride(), r.beta, advect1_.data(), r.s, r.z);
  fft_.inverse(r.z, a);
  for (Index j = 0; j < n; ++j) w[j] = fma_lanes(a[j], a[j], -(u[j] * u[j]));
  fft_.forward(w, r.z);
  add_turned<Fft>(stride(), r.beta, advect2_.data(), r.s, r.z);
  fft_.inverse(r.z, u_new);
}

/// d(beta u^2) = 2 beta u du, and u^2 more along beta.
template <class T, class Fft>
template <class P>
void Etdrk2<T, Fft>::tangent_step(const Etdrk2Run<P>& r,
                                  const P* u,
                                  const P* a,
                                  const Etdrk2Tangent<P>& along_alpha,
                                  const Etdrk2Tangent<P>& along_beta) const {
  const Index n = field();
  const P twice = 2 * r.beta, one = P{} + T(1);
  P *w = r.w, *z = r.z;
  const auto advance = [&](const Etdrk2Tangent<P>& t, bool alpha) {
    const P own = P{} + T(alpha ? 0 : 1);
    const auto change = [&](P d, P v) {
      return fma_lanes(twice, d, own * v) * v;
    };
    for (Index j = 0; j < n; ++j) w[j] = change(t.du[j], u[j]);
    fft_.forward(w, z);
    propagate(alpha ? one : P{}, t.ds);
    add_turned<Fft>(stride(), one, advect1_.data(), t.ds, z);
    fft_.inverse(z, t.da);
    for (Index j = 0; j < n; ++j)
      w[j] = change(t.da[j], a[j]) - change(t.du[j], u[j]);
    fft_.forward(w, z);
    add_turned<Fft>(stride(), one, advect2_.data(), t.ds, z);
    fft_.inverse(z, t.du);
  };
  advance(along_alpha, true);
  advance(along_beta, false);
}

/// With lambda = dL/du_new and D = (i k P), antisymmetric: q = D2 lambda,
/// la = lambda + beta a q, r = D1 la - q, lambda := E la + beta u r. The
/// multipliers of the way forward give -q / (2 cells) and -r / (2 cells) here.
template <class T, class Fft>
template <class P>
void Etdrk2<T, Fft>::back_step(const Etdrk2Run<P>& r,
                               const P* u,
                               const P* a,
                               const Etdrk2Sums<P>& sums) const {
  const Index n = field(), count = stride();
  const P scale = -2 * r.beta;
  P* __restrict w = r.w, * __restrict s = r.s, * __restrict z = r.z;
  P* __restrict by_alpha = sums.alpha, * __restrict by_beta = sums.beta;
  const auto e = [&](Index i) { return weights<P>(exp_, i); };
  const auto c1 = [&](Index i) { return weights<P>(advect1_, i); };
  const auto c2 = [&](Index i) { return weights<P>(advect2_, i); };

  for (Index i = 0; i < count; i += 2) {
    z[i] = c2(i) * s[i + 1];
    z[i + 1] = c2(i + 1) * s[i];
  }
  fft_.inverse(z, w);
  for (Index j = 0; j < n; ++j) {
    w[j] *= a[j];
    by_beta[j] = fma_lanes(w[j], a[j], by_beta[j]);
  }
  fft_.forward(w, z);
  for (Index i = 0; i < count; i += 2) {
    const P re = s[i], im = s[i + 1];
    const P la_re = fma_lanes(scale, z[i], re);
    const P la_im = fma_lanes(scale, z[i + 1], im);
    by_alpha[i] += la_re;
    by_alpha[i + 1] += la_im;
    s[i] = e(i) * la_re;
    s[i + 1] = e(i + 1) * la_im;
    z[i] = fma_lanes(c1(i), la_im, -(c2(i) * im));
    z[i + 1] = fma_lanes(c1(i + 1), la_re, -(c2(i + 1) * re));
  }
  fft_.inverse(z, w);
  for (Index j = 0; j < n; ++j) {
    w[j] *= u[j];
    by_beta[j] = fma_lanes(w[j], u[j], by_beta[j]);
  }
  fft_.forward(w, z);
  for (Index i = 0; i < count; ++i) s[i] = fma_lanes(scale, z[i], s[i]);
}

/// Parseval: modes between the ends stand for their conjugates too, and
/// spectra are divided by `cells` where one product would want it once.
template <class T, class Fft>
template <class P>
P Etdrk2<T, Fft>::alpha_bar(const Etdrk2Sums<P>& sums) const {
  const Index n = cells_;
  const auto term = [&](Index i, P sum) {
    const Index at = fft_.place(i);
    return fma_lanes(forcing_(at), Fft::taken(sums.alpha, at), sum);
  };
  P sum{};
  for (Index i = 2; i < n; ++i) sum = term(i, sum);
  return static_cast<T>(n) * term(n, term(0, 2 * sum));
}

template <class T, class Fft>
template <class P>
P Etdrk2<T, Fft>::beta_bar(const Etdrk2Sums<P>& sums) const {
  P sum{};
  for (Index j = 0; j < cells_; ++j) sum += Fft::taken(sums.beta, point(j));
  return -static_cast<T>(cells_) * sum;
}

#define PHYSINV_STEPS(T, Fft, P)                                             \
  template void Etdrk2<T, Fft>::begin(const Etdrk2Run<P>&, const P*) const;  \
  template void Etdrk2<T, Fft>::restore(const Etdrk2Run<P>&, P*) const;      \
  template void Etdrk2<T, Fft>::drift(const Etdrk2Run<P>&) const;            \
  template void Etdrk2<T, Fft>::step(const Etdrk2Run<P>&, const P*, P*, P*)  \
      const;                                                                 \
  template void Etdrk2<T, Fft>::tangent_step(const Etdrk2Run<P>&,            \
                                             const P*,                       \
                                             const P*,                       \
                                             const Etdrk2Tangent<P>&,        \
                                             const Etdrk2Tangent<P>&) const; \
  template void Etdrk2<T, Fft>::back_step(                                   \
      const Etdrk2Run<P>&, const P*, const P*, const Etdrk2Sums<P>&) const;  \
  template P Etdrk2<T, Fft>::alpha_bar(const Etdrk2Sums<P>&) const;          \
  template P Etdrk2<T, Fft>::beta_bar(const Etdrk2Sums<P>&) const;
using F4 = Pack<float, 4>;
using F8 = Pack<float, 8>;
using D2 = Pack<double, 2>;
using D4 = Pack<double, 4>;
PHYSINV_STEPS(float, LanesFft<float>, F4)
PHYSINV_STEPS(float, LanesFft<float>, F8)
PHYSINV_STEPS(float, FoursFft<float>, F4)
PHYSINV_STEPS(float, FoursFft<float>, F8)
PHYSINV_STEPS(double, LanesFft<double>, D2)
PHYSINV_STEPS(double, LanesFft<double>, D4)
PHYSINV_STEPS(double, FoursFft<double>, D4)
#ifdef PHYSINV_AVX512
using F16 = Pack<float, 16>;
using D8 = Pack<double, 8>;
PHYSINV_STEPS(float, LanesFft<float>, F16)
PHYSINV_STEPS(float, FoursFft<float>, F16)
PHYSINV_STEPS(double, LanesFft<double>, D8)
PHYSINV_STEPS(double, FoursFft<double>, D8)
#endif
#undef PHYSINV_STEPS

template class Etdrk2<float, LanesFft<float>>;
template class Etdrk2<float, FoursFft<float>>;
template class Etdrk2<double, LanesFft<double>>;
template class Etdrk2<double, FoursFft<double>>;

}  // namespace physinv
