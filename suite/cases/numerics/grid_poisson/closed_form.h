/// The Laplacian by its stencil.
#pragma once

#include <algorithm>

#include "problems/grid_poisson/grid_poisson.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm grid_poisson_closed_form() {
  return {[](auto x, auto, auto y) {
    const auto at = [&](Index i, Index j) {
      const bool inside = std::min(i, j) >= 0 && std::max(i, j) < kPoissonSide;
      return inside ? x[static_cast<std::size_t>(kPoissonSide * i + j)]
                    : Exact(0);
    };
    for (Index i = 0; i < kPoissonSide; ++i)
      for (Index j = 0; j < kPoissonSide; ++j)
        y[static_cast<std::size_t>(kPoissonSide * i + j)] =
            at(i - 1, j) + at(i + 1, j) + at(i, j - 1) + at(i, j + 1) -
            4 * at(i, j);
  }};
}

}  // namespace physinv
