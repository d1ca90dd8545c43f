/// Matrices with known singular values, and the definition of a power of them.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "optimizers/half_inverse/two_level.h"

namespace physinv::hig {

inline Batch<double> noise(Index rows, Index cols, std::uint32_t seed) {
  Batch<double> x(rows, cols);
  std::uint32_t k = seed * 7919u;
  const auto uniform = [&] {
    std::uint32_t h = ++k;
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return ((h ^ (h >> 16)) + 0.5) / 4294967296.0;
  };
  for (Index i = 0; i < x.size(); ++i)
    x.data()[i] =
        std::sqrt(-2 * std::log(uniform())) * std::cos(2 * M_PI * uniform());
  return x;
}

/// n orthonormal columns.
inline Batch<double> orthonormal(Index rows, Index n, std::uint32_t seed) {
  const Eigen::HouseholderQR<Batch<double>> qr(noise(rows, n, seed));
  Batch<double> q = Batch<double>::Identity(rows, n);
  q.applyOnTheLeft(qr.householderQ());
  return q;
}

/// Singular values 1 .. 10^-decades between random bases.
inline Batch<double> graded(Index m,
                            Index p,
                            double decades,
                            std::uint32_t seed) {
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

/// The definition, by Eigen's two-sided Jacobi SVD of J.
struct Definition {
  Eigen::JacobiSVD<Batch<double>> svd;
  Vector<double> c;
  Definition(const Batch<double>& j, const Vector<double>& g)
      : svd(j, Eigen::ComputeThinU | Eigen::ComputeThinV),
        c(svd.matrixU().transpose() * g) {}

  double cut(const Power& p) const {
    return p.absolute ? p.tau : p.tau * svd.singularValues()(0);
  }
  Index kept(const Power& p) const {
    return (svd.singularValues().array() > cut(p)).count();
  }
  Vector<double> update(const Power& p) const {
    Vector<double> w = c;
    for (Index i = 0; i < w.size(); ++i) {
      const double s = svd.singularValues()(i);
      w(i) *= s > cut(p) ? std::pow(s, p.kappa) : 0.0;
    }
    return std::pow(svd.singularValues()(0), p.beta) * (svd.matrixV() * w);
  }
};

inline Pullback pullback_of(const Batch<double>& j) {
  return [&j](BatchIn<double> u, BatchOut<double> out) {
    out.noalias() = j.transpose() * u;
  };
}

}  // namespace physinv::hig
