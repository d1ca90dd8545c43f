/// How far the first trial of a quasi-Newton method goes along the negative
/// gradient, before it knows any curvature. Libraries differ most in this.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace physinv {

enum class FirstTrial : std::uint8_t {
  scipy,           ///< the gradient, of length 1.01 at most
  shorter,         ///< the gradient, of length 1 at most: Ceres, ALGLIB
  gradient,        ///< the gradient: R, NLopt, dlib
  tenth_gradient,  ///< a tenth of it: nlm where it is steep
  length_1,        ///< length 1: L-BFGS-B, libLBFGS
  length_tenth,    ///< length 0.1: Scilab
};

constexpr std::string_view to_string(FirstTrial rule) {
  constexpr std::string_view names[] = {"scipy",
                                        "shorter",
                                        "gradient",
                                        "tenth_gradient",
                                        "length_1",
                                        "length_tenth"};
  return names[static_cast<std::size_t>(rule)];
}

/// The length over that of the gradient, which is `norm`. SciPy's follows from
/// a loss that it invents for the point before (bfgs.cpp); here it is in exact
/// arithmetic.
constexpr double first_trial(FirstTrial rule, double norm) {
  switch (rule) {
    case FirstTrial::scipy:
      return std::min(1.0, 1.01 / norm);
    case FirstTrial::shorter:
      return std::min(1.0, 1 / norm);
    case FirstTrial::gradient:
      return 1;
    case FirstTrial::tenth_gradient:
      return 0.1;
    case FirstTrial::length_1:
      return 1 / norm;
    case FirstTrial::length_tenth:
      return 0.1 / norm;
  }
  return 1;
}

}  // namespace physinv
