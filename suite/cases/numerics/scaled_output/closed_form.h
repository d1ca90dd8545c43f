/// The scaled output.
#pragma once

#include "problems/scaled_output/scaled_output.h"
#include "suite/core/closed_form.h"

namespace physinv {

inline ClosedForm scaled_output_closed_form(const ScaledOutputOptions& o = {}) {
  return {[=](auto x, auto, auto y) {
    y[0] = x[0];
    y[1] = o.gamma * x[1];
  }};
}

}  // namespace physinv
