/// Poisson's equation on a rectangle of unit cells: which source has a given
/// potential? (Scale-invariant physics training, App. B.2.)
///
///   L y = x,  (L y)_ij = y_{i-1,j} + y_{i+1,j} + y_{i,j-1} + y_{i,j+1} - 4
///   y_ij
///
/// with y = 0 one cell outside. L is symmetric and negative definite, its
/// eigenvectors are products of sines: with S_n orthogonal and symmetric,
/// (S_n)_ik = sqrt(2 / (n + 1)) sin(pi i k / (n + 1)),
///
///   y = S_p ((S_p x S_q) / lambda) S_q,
///   lambda_kl = 2 cos(pi k / (p + 1)) + 2 cos(pi l / (q + 1)) - 4
///
/// Unknown x: the source, cell (i, j) at q i + j (p q). Given: nothing.
/// Observation y: the potential. vjp: exact, the solution is its own adjoint.
/// invert: x = L y, exact; it needs no guess.
///
/// Computed in double, also where T is float. By default the exact solution;
/// with `relative` > 0 conjugate gradients as the authors' code has them, from
/// 0 until |residual| <= relative |x| for each sample by itself.
///
/// What is not finite stays in its own column.
#pragma once

#include "suite/core/recipe.h"

namespace physinv {

struct PoissonOptions {
  Index rows = 64, columns = 64;  ///< p, q
  double relative = 0;            ///< 0: the exact solution
  Index most = 1000;              ///< iterations of conjugate gradients

  auto fields() const {
    return std::tuple{field("rows", rows),
                      field("columns", columns),
                      if_changed(field("relative", relative)),
                      if_changed(field("most", most))};
  }
};

/// Smooth random source of zero mean and unit variance (population): the real
/// part of the inverse Fourier transform of c / k^2 for complex noise c = re +
/// i im and k = 10 f, f in cycles per cell, without k^2 <= 0.1.
Batch<double> poisson_source(const Batch<double>& re, const Batch<double>& im);

/// Eigenvalues of L, q x p.
Batch<double> poisson_eigenvalues(Index rows, Index columns);

/// L y of one field, p x q.
Batch<double> laplacian(const Batch<double>& y);

namespace problems {
ProblemRecipe poisson(const PoissonOptions& options = {});
}

}  // namespace physinv
