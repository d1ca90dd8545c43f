#include "tests/optimizers/half_inverse_truth.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "tests/support/singular_values.h"

namespace physinv::hig {

Batch<double> noise(Index rows, Index cols, std::uint32_t seed) {
  Batch<double> x(rows, cols);
  std::uint32_t k = seed * 7919u;
  const auto uniform = [&] {
    std::uint32_t h = ++k;
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return ((h ^ (h >> 16)) + 0.5) / 4294967296.0;
  };
  for (double& z : x.reshaped()) {
    z = std::sqrt(-2 * std::log(uniform()));
    z *= std::cos(2 * M_PI * uniform());
  }
  return x;
}

Batch<double> orthonormal(Index rows, Index n, std::uint32_t seed) {
  const Eigen::HouseholderQR<Batch<double>> qr(noise(rows, n, seed));
  Batch<double> q = Batch<double>::Identity(rows, n);
  q.applyOnTheLeft(qr.householderQ());
  return q;
}

Batch<double> graded(Index m, Index p, double decades, std::uint32_t seed) {
  const Index n = std::min(m, p);
  Vector<double> s(n);
  for (Index i = 0; i < n; ++i)  // not on a power of ten, where the cuts are
    s(i) = std::pow(
        10.0,
        -decades * (static_cast<double>(i) + 0.37) / static_cast<double>(n));
  s(0) = 1;
  return orthonormal(m, n, seed) * s.asDiagonal() *
         orthonormal(p, n, seed + 1).transpose();
}

Definition::Definition(const Batch<double>& j, const Vector<double>& g)
    : svd(test::jacobi_singular_values(j)), c(svd.u.transpose() * g) {}

double Definition::cut(const Power& p) const {
  return p.absolute ? p.tau : p.tau * svd.s(0);
}

Index Definition::kept(const Power& p) const {
  return (svd.s.array() > cut(p)).count();
}

Vector<double> Definition::update(const Power& p) const {
  Vector<double> w = c;
  for (Index i = 0; i < w.size(); ++i) {
    const double s = svd.s(i);
    w(i) *= s > cut(p) ? std::pow(s, p.kappa) : 0.0;
  }
  return std::pow(svd.s(0), p.beta) * (svd.v * w);
}

Pullback pullback_of(const Batch<double>& j) {
  return [&j](BatchIn<double> u, BatchOut<double> out) {
    out.noalias() = j.transpose() * u;
  };
}

}  // namespace physinv::hig
