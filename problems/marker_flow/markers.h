/// Marker densities and the vortex of the periodic square, cells (i, j) with j
/// the fastest, centres at (i + 1/2) dx.
#pragma once

#include "suite/core/batch.h"
#include "suite/core/math.h"

namespace physinv {

/// A grid of cells x cells over [0, box]^2.
struct MarkerGrid {
  Index cells = 64;
  double box = 128;

  double at(Index i) const { return (double(i) + 0.5) * box / double(cells); }
};

struct MarkerPoint {
  double x, y;
};

/// A random marker: within |x - centre| <= half on both axes, where the noise
/// is positive.
struct MarkerPatch {
  MarkerPoint centre;
  double half;
  double fill;  ///< of all cells, at most
};

/// How many cells hold the largest noise: K = n - round(n (1 - fill)).
Index marked_cells(const MarkerGrid& grid, double fill);

/// 1 in those of the K cells of largest noise that are within the patch and
/// positive, 0 elsewhere.
Vector<double> marker(const MarkerGrid& grid,
                      const MarkerPatch& patch,
                      VectorIn<double> noise);

/// Not across the border; the middle of the box where nothing is.
MarkerPoint centre_of_mass(const MarkerGrid& grid, VectorIn<double> density);

/// The vortex W = exp(-|r|^2 / (2 width^2)) (-r_y, r_x), r from the middle.
struct Vortex {
  MarkerGrid grid;
  double width = 20;
  double moment = 120.5;  ///< of the authors; of W itself it is 120.519

  /// Component 0 or 1 of W in cell (i, j).
  double operator()(int component, Index i, Index j) const {
    const double x = from_middle(i), y = from_middle(j);
    return math::exp(-0.5 * (x * x + y * y) / (width * width)) *
           (component == 0 ? -y : x);
  }
  double from_middle(Index i) const { return grid.at(i) - 0.5 * grid.box; }

  /// How much of it a field (component, i, j) holds: mean(r x field) / moment.
  double strength(VectorIn<double> field) const;
};

}  // namespace physinv
