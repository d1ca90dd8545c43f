/// How things end: one example, and one stage.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace physinv {

/// An example's end, with SciPy's meanings. Files have the numbers.
enum class Status : std::uint8_t {
  gtol,        ///< largest gradient entry within the tolerance, or a zero step
  maxiter,     ///< out of iterations
  linesearch,  ///< no acceptable step along the direction
  nonfinite,   ///< a value that is not finite; x is the last good point
  ftol,        ///< the loss hardly fell: on a plateau, or at a minimum
};

inline constexpr std::array kStatuses{Status::gtol,
                                      Status::maxiter,
                                      Status::linesearch,
                                      Status::nonfinite,
                                      Status::ftol};

/// Did the example fulfil a tolerance?
constexpr bool converged(Status s) {
  return s == Status::gtol || s == Status::ftol;
}

/// A stage's end. Divergence is a result; `failed` is not.
enum class Stop : std::uint8_t {
  converged,   ///< every example fulfils a tolerance
  iterations,  ///< ran its iterations
  diverged,    ///< no finite loss is left to improve
  failed,      ///< an exception, or out of memory
  skipped,     ///< not run, see the message
};

constexpr std::string_view to_string(Status s) {
  constexpr std::string_view names[] = {
      "gtol", "maxiter", "linesearch", "nonfinite", "ftol"};
  return names[static_cast<std::size_t>(s)];
}

constexpr std::string_view to_string(Stop s) {
  constexpr std::string_view names[] = {
      "converged", "iterations", "diverged", "failed", "skipped"};
  return names[static_cast<std::size_t>(s)];
}

}  // namespace physinv
