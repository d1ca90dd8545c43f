/// Matrices with known singular values, and the definition of a power of them.
#pragma once

#include <cstdint>

#include "optimizers/half_inverse/two_level.h"
#include "suite/linalg/decompositions.h"

namespace physinv::hig {

Batch<double> noise(Index rows, Index cols, std::uint32_t seed);

/// n orthonormal columns.
Batch<double> orthonormal(Index rows, Index n, std::uint32_t seed);

/// Singular values 1 .. 10^-decades between random bases.
Batch<double> graded(Index m, Index p, double decades, std::uint32_t seed);

/// The definition, by Eigen's two-sided Jacobi SVD of J.
struct Definition {
  linalg::SingularValues svd;
  Vector<double> c;
  Definition(const Batch<double>& j, const Vector<double>& g);

  double cut(const Power& p) const;
  Index kept(const Power& p) const;
  Vector<double> update(const Power& p) const;
};

Pullback pullback_of(const Batch<double>& j);

}  // namespace physinv::hig
