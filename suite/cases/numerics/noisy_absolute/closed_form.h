/// The noisy distance; what is given says how many terms there are.
#pragma once

#include "problems/noisy_absolute/noisy_absolute.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm noisy_absolute_closed_form() {
  return {[](auto x, auto given, auto y) {
    const std::size_t terms = (given.size() - 3) / 3;
    const Exact away = x[0] - Exact(given[1]);
    y[0] = given[2] * (away.value < 0 ? -away : away);
    for (std::size_t j = 0; j < terms; ++j) {
      const double a = given[3 + j], w = given[3 + terms + j],
                   phi = given[3 + 2 * terms + j];
      y[0] -= a * cos(w * x[0] + phi);
    }
  }};
}

}  // namespace physinv
