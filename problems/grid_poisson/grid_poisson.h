/// Poisson's equation on a small grid: which potential has a given source?
/// (Half-inverse gradients, Sec. 3.2, App. B.3, Figs. 3, 7; the ghost values
/// and the data are those of the authors' code.)
///
///   y = L x,  (L x)_ij = x_{i-1,j} + x_{i+1,j} + x_{i,j-1} + x_{i,j+1} - 4
///   x_ij
///
/// 8 x 8 cells, spacing 1, x = 0 one spacing outside the grid. L is symmetric
/// with eigenvalues lambda_kl = -4 + 2 cos(k pi/9) + 2 cos(l pi/9), k, l =
/// 1 .. 8, from -7.76 to -0.24, and sine eigenvectors: with the symmetric,
/// orthogonal S_ik = sqrt(2/9) sin(i k pi/9),
///
///   L^{-1} y = S ((S y S) / lambda) S
///
/// Unknown x: the potential, cell (i, j) at 8 i + j (64). Given: nothing.
/// Observation y: the source (64). vjp, Jacobian: exact and constant.
/// invert: exact; it needs no guess.
///
/// What is not finite stays in its own column.
#pragma once

#include "suite/core/recipe.h"

namespace physinv {

inline constexpr Index kPoissonSide = 8;
inline constexpr Index kPoissonCells = kPoissonSide * kPoissonSide;

struct GridPoissonOptions {
  auto fields() const { return std::tuple{}; }
};

/// Smooth random potential: with complex noise c (real parts, then imaginary
/// parts, 64 each, frequency 8 k + l) the real part of the inverse Fourier
/// transform of c / |f|^2 without its mean frequency, divided by its standard
/// deviation over the cells, minus its mean.
Vector<double> poisson_potential(const Vector<double>& noise);

namespace problems {
ProblemRecipe grid_poisson(const GridPoissonOptions& options = {});
}

}  // namespace physinv
