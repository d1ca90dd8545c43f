#include "problems/kuramoto_sivashinsky/etdrk2.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "suite/core/workspace.h"

namespace physinv {
namespace {

/// phi1 and phi2: (e^z - 1) / z and (e^z - 1 - z) / z^2; their differences
/// cancel near 0, where the series to z^5 is exact to rounding.
std::array<double, 2> phi(double z) {
  if (std::abs(z) >= 1e-2) {
    const double e = std::expm1(z);
    return {e / z, (e - z) / (z * z)};
  }
  double one = 1, two = 1;
  for (int i = 6; i > 1; --i) one = 1 + z / i * one;
  for (int i = 7; i > 2; --i) two = 1 + z / i * two;
  return {one, two / 2};
}

double forcing_at(double x) {
  return 0.1 * std::cos(x) -
         0.01 * std::cos(x / 16) * (1 - 2 * std::sin(x / 16));
}

/// s := s + scale (-i c) z, and z := s, which transforms may destroy.
template <class T>
void add_turned(Index count,
                T scale,
                const Vector<T>& c,
                T* __restrict s,
                T* __restrict z) {
  const T* __restrict turn = c.data();
  for (Index i = 0; i < count; i += 2) {
    const T re = z[i], im = z[i + 1];
    z[i] = s[i] += scale * turn[i] * im;
    z[i + 1] = s[i + 1] += scale * turn[i + 1] * re;
  }
}

/// z := (-i c) s
template <class T>
void turn_into(Index count, const Vector<T>& c, const T* s, T* __restrict z) {
  const T* __restrict turn = c.data();
  for (Index i = 0; i < count; i += 2) {
    z[i] = turn[i] * s[i + 1];
    z[i + 1] = turn[i + 1] * s[i];
  }
}

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
    op.exp(m) = std::exp(l * o.time_step);
    op.dt_phi1(m) = o.time_step * phi1;
    op.dt_phi2(m) = o.time_step * phi2;
  }
  op.forcing.resize(o.cells);
  for (Index j = 0; j < o.cells; ++j)
    op.forcing(j) = forcing_at((double(j) + 0.5) * (o.box / double(o.cells)));
  return op;
}

template <class T>
Etdrk2<T>::Etdrk2(const KuramotoSivashinskyOperators& op)
    : cells_(op.forcing.size()), fft_(cells_), pair_(cells_, 2) {
  const Index modes = op.k.size();
  const double n = static_cast<double>(cells_);
  const RealFft<double> fft(cells_);
  Workspace work;
  auto g = work.take<double>(cells_, 1);
  auto spectrum = work.take<double>(2 * modes, 1);
  g = op.forcing;
  fft.forward(g.data(), spectrum.data());
  for (auto* v : {&exp_, &forcing_, &advect1_, &advect2_}) v->resize(2 * modes);
  for (Index i = 0; i < 2 * modes; ++i) {
    const Index m = i / 2;
    // The Nyquist mode has no derivative.
    const double k = m == modes - 1 ? 0 : op.k(m) * (i % 2 == 0 ? 1 : -1);
    exp_(i) = static_cast<T>(op.exp(m));
    forcing_(i) = static_cast<T>(op.dt_phi1(m) * spectrum(i) / n);
    advect1_(i) = static_cast<T>(k * op.dt_phi1(m) / (2 * n));
    advect2_(i) = static_cast<T>(k * op.dt_phi2(m) / (2 * n));
  }
}

template <class T>
void Etdrk2<T>::begin(const Run& r, const T* u) const {
  fft_.forward(u, r.s);
  const T scale = T(1) / static_cast<T>(cells_);
  for (Index i = 0; i < cells_ + 2; ++i) r.s[i] *= scale;
}

template <class T>
void Etdrk2<T>::restore(const Run& r, T* u) const {
  std::copy_n(r.s, cells_ + 2, r.z);
  fft_.inverse(r.z, u);
}

/// s := E s + alpha P1 G^
template <class T>
void Etdrk2<T>::propagate(T alpha, T* s) const {
  const T *e = exp_.data(), *f = forcing_.data();
  const Index count = cells_ + 2;
  if (alpha == 0) {
    for (Index i = 0; i < count; ++i) s[i] *= e[i];
  } else {
    for (Index i = 0; i < count; ++i) s[i] = e[i] * s[i] + alpha * f[i];
  }
}

template <class T>
void Etdrk2<T>::drift(const Run& r) const {
  propagate(r.alpha, r.s);
}

template <class T>
[[gnu::noinline]] void Etdrk2<T>::step(const Run& r,
                                       const T* u,
                                       T* a,
                                       T* u_new) const {
  const Index n = cells_;
  T* __restrict w = r.w;
  for (Index j = 0; j < n; ++j) w[j] = u[j] * u[j];
  fft_.forward(w, r.z);
  propagate(r.alpha, r.s);
  add_turned(n + 2, r.beta, advect1_, r.s, r.z);
  fft_.inverse(r.z, a);
  for (Index j = 0; j < n; ++j) w[j] = a[j] * a[j] - u[j] * u[j];
  fft_.forward(w, r.z);
  add_turned(n + 2, r.beta, advect2_, r.s, r.z);
  fft_.inverse(r.z, u_new);
}

template <class T>
void Etdrk2<T>::tangent_step(T beta,
                             const T* u,
                             const T* a,
                             const Tangents& t) const {
  const Index n = cells_, h = pair_.spectrum_stride();
  T* __restrict w = t.w, *du = t.du, *da = t.da;
  const T twice = 2 * beta;
  for (Index j = 0; j < n; ++j) {
    w[j] = twice * du[j] * u[j];
    w[n + j] = (twice * du[n + j] + u[j]) * u[j];
  }
  pair_.forward(w, t.z);
  for (Index d = 0; d < 2; ++d) {
    propagate(static_cast<T>(1 - d), t.ds + d * h);
    add_turned(n + 2, T(1), advect1_, t.ds + d * h, t.z + d * h);
  }
  pair_.inverse(t.z, da);
  for (Index j = 0; j < n; ++j) {
    w[j] = twice * (da[j] * a[j] - du[j] * u[j]);
    w[n + j] =
        (twice * da[n + j] + a[j]) * a[j] - (twice * du[n + j] + u[j]) * u[j];
  }
  pair_.forward(w, t.z);
  for (Index d = 0; d < 2; ++d)
    add_turned(n + 2, T(1), advect2_, t.ds + d * h, t.z + d * h);
  pair_.inverse(t.z, du);
}

/// With lambda = dL/du_new and D = (i k P), antisymmetric: q = D2 lambda,
/// la = lambda + beta a q, r = D1 la - q, lambda := E la + beta u r. The
/// multipliers of the way forward give -q / (2 cells) and -r / (2 cells) here.
template <class T>
void Etdrk2<T>::back_step(const Run& r,
                          const T* u,
                          const T* a,
                          const Sums& sums) const {
  const Index n = cells_;
  const T scale = -2 * r.beta;
  T* __restrict w = r.w, * __restrict s = r.s, * __restrict z = r.z;
  T* __restrict by_alpha = sums.alpha, * __restrict by_beta = sums.beta;
  const T *e = exp_.data(), *c1 = advect1_.data(), *c2 = advect2_.data();

  turn_into(n + 2, advect2_, s, z);
  fft_.inverse(z, w);
  for (Index j = 0; j < n; ++j) {
    w[j] *= a[j];
    by_beta[j] += w[j] * a[j];
  }
  fft_.forward(w, z);
  for (Index i = 0; i < n + 2; i += 2) {
    const T re = s[i], im = s[i + 1];
    const T la_re = re + scale * z[i], la_im = im + scale * z[i + 1];
    by_alpha[i] += la_re;
    by_alpha[i + 1] += la_im;
    s[i] = e[i] * la_re;
    s[i + 1] = e[i + 1] * la_im;
    z[i] = c1[i] * la_im - c2[i] * im;
    z[i + 1] = c1[i + 1] * la_re - c2[i + 1] * re;
  }
  fft_.inverse(z, w);
  for (Index j = 0; j < n; ++j) {
    w[j] *= u[j];
    by_beta[j] += w[j] * u[j];
  }
  fft_.forward(w, z);
  for (Index i = 0; i < n + 2; ++i) s[i] += scale * z[i];
}

/// Parseval: modes between the ends stand for their conjugates too, and
/// spectra are divided by `cells` where one product would want it once.
template <class T>
T Etdrk2<T>::alpha_bar(const Sums& sums) const {
  const Index n = cells_;
  T sum = 0;
  for (Index i = 2; i < n; ++i) sum += forcing_(i) * sums.alpha[i];
  return static_cast<T>(n) *
         (forcing_(0) * sums.alpha[0] + 2 * sum + forcing_(n) * sums.alpha[n]);
}

template <class T>
T Etdrk2<T>::beta_bar(const Sums& sums) const {
  T sum = 0;
  for (Index j = 0; j < cells_; ++j) sum += sums.beta[j];
  return -static_cast<T>(cells_) * sum;
}

template class Etdrk2<float>;
template class Etdrk2<double>;

}  // namespace physinv
