#include "problems/marker_flow/markers.h"

#include <algorithm>
#include <vector>

#include "suite/core/check.h"

namespace physinv {

Index marked_cells(const MarkerGrid& grid, double fill) {
  const auto all = double(grid.cells * grid.cells);
  return static_cast<Index>(all - std::nearbyint(all * (1 - fill)));
}

Vector<double> marker(const MarkerGrid& grid,
                      const MarkerPatch& patch,
                      VectorIn<double> noise) {
  const Index n = grid.cells;
  check_size(noise, n * n, 1);
  const auto inside = [&](Index i, double centre) {
    return std::abs(grid.at(i) - centre) <= patch.half;
  };
  std::vector<Index> found;  // no other can be among the largest and stay
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (inside(i, patch.centre.x) && inside(j, patch.centre.y) &&
          noise(i * n + j) > 0)
        found.push_back(i * n + j);
  std::stable_sort(found.begin(), found.end(), [&](Index a, Index b) {
    return noise(a) > noise(b);
  });
  const auto most = static_cast<std::size_t>(marked_cells(grid, patch.fill));
  found.resize(std::min(found.size(), most));
  Vector<double> m = Vector<double>::Zero(n * n);
  for (const Index a : found) m(a) = 1;
  return m;
}

MarkerPoint centre_of_mass(const MarkerGrid& grid, VectorIn<double> density) {
  const Index n = grid.cells;
  check_size(density, n * n, 1);
  double mass = 0, x = 0, y = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const double m = density(i * n + j);
      mass += m;
      x = std::fma(m, grid.at(i), x), y = std::fma(m, grid.at(j), y);
    }
  if (mass == 0) return {0.5 * grid.box, 0.5 * grid.box};
  return {x / mass, y / mass};
}

double Vortex::strength(VectorIn<double> field) const {
  const Index n = grid.cells;
  check_size(field, 2 * n * n, 1);
  double sum = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      sum = std::fma(field(n * n + i * n + j), from_middle(i), sum);
      sum = std::fma(-field(i * n + j), from_middle(j), sum);
    }
  return sum / (double(n * n) * moment);
}

}  // namespace physinv
