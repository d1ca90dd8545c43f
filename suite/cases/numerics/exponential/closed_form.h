/// The exponential.
#pragma once

#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm exponential_closed_form() {
  return {[](auto x, auto, auto y) { y[0] = exp(x[0]); }};
}

}  // namespace physinv
