/// Diffusion as a sum over cells: y = A x A, A_ij = c_(i-j), c the field that a
/// single hot cell of one dimension becomes.
#pragma once

#include <vector>

#include "problems/heat/heat.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm heat_closed_form(const HeatOptions& options = {}) {
  const auto n = static_cast<std::size_t>(options.resolution);
  std::vector<DoubleDouble> c(n);
  constexpr DoubleDouble kTurn(0x1.921fb54442d18p2, 0x1.1a62633145c07p-52);
  const DoubleDouble turn = kTurn / double(n);  // 2 pi / n
  for (std::size_t d = 0; d < n; ++d)
    for (std::size_t k = 0; k < n; ++k) {
      const DoubleDouble wave = turn * double(k < n - k ? k : n - k);
      c[d] += exp(-wave * wave * options.end_time) *
              sine_cosine(turn * double(k * d % n)).cosine / double(n);
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
