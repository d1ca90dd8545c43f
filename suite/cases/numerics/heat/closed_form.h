/// Diffusion as a sum over cells: y = A x A, A_ij = c_(i-j), c the field that a
/// single hot cell of one dimension becomes.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "problems/heat/heat.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm heat_closed_form(const HeatOptions& options = {}) {
  const auto n = static_cast<std::size_t>(options.resolution);
  std::vector<long double> c(n, 0);
  for (std::size_t d = 0; d < n; ++d)
    for (std::size_t k = 0; k < n; ++k) {
      const long double turn = 2 * std::numbers::pi_v<long double> / n;
      const long double wave =
          turn * static_cast<long double>(k < n - k ? k : n - k);
      c[d] += exact_exp(-wave * wave * options.end_time).real() *
              std::cos(turn * static_cast<long double>(k * d % n)) / n;
    }
  return {[n, c](auto x, auto, auto y) {
    std::vector<Exact> rows(n * n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t j = 0; j < n; ++j)
          rows[n * i + j] += c[(n + i - a) % n] * x[n * a + j];
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        Exact sum = 0;
        for (std::size_t b = 0; b < n; ++b)
          sum += c[(n + j - b) % n] * rows[n * i + b];
        y[n * i + j] = sum;
      }
  }};
}

}  // namespace physinv
